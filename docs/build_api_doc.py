"""Writes `docs/api.md` from the docstrings of what `import evdash` offers.

Run `python docs/build_api_doc.py` after changing one; a test holds both in step.
"""

import inspect
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from docstring_parser import Docstring, DocstringStyle, parse

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

import evdash  # noqa: E402 - the path above makes it so

INTRODUCTION = """\
# evdash from Python

Written by `docs/build_api_doc.py` from the docstrings in `evdash/api`. All that `import evdash`
offers is here; the examples are run by the tests.

```python
import evdash

scenario = evdash.load("summer-weekday")  # a bundled day, a folder or a .zip
day = scenario.run(policy="p1", seed=7)  # interval by interval, each plan certified
print(day)  # what became of promises
refused = day.vehicles.query("status == 'refused'")  # the tables of a run's files, as frames
print(day.explain(refused.vehicle.iloc[0]).text)  # why, and what would have admitted it
day.plot("load").write_html("load.html")  # a plotly figure
day.report("report.html")  # to be handed on
```

The columns of a day's tables are those of [a run's files](scenario.md#what-a-run-writes), with
their units in `table.attrs["units"]`. What a scenario holds says the same page,
[policies.md](policies.md) who may decide, [studies.md](studies.md) what can be varied and measured.
Wrong input raises `evdash.InputError`, which names every fault there is, in `faults`.
"""
ORDER = ("load", "Scenario", "Day", "Race", "Study", "study", "Comparison", "compare")
ERRORS = """\
## Errors

`evdash.EvdashError` is the base of every error evdash raises on purpose, `evdash.InputError` of
these says what is wrong with what it was given: `faults` holds them all, each with `place`,
`found` and `allowed`.
"""


def document() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for name in ORDER:
        thing = getattr(evdash, name)
        parts += of_class(thing) if inspect.isclass(thing) else of_function(f"evdash.{name}", thing)
    return "\n".join(part for part in [*parts, ERRORS] if part)


def of_class(thing: type) -> Iterator[str]:
    """A class: what it is, what it holds, what it does."""
    told = parsed(thing)
    yield f"## `evdash.{thing.__name__}`\n\n{prose(told)}\n"
    held = [(param.arg_name, param.type_name, param.description) for param in told.params]
    yield table(("attribute", "type", "meaning"), held)
    own = {name: part for name, part in vars(thing).items() if not name.startswith("_")}
    worked = [
        (name, prose(parsed(part)))
        for name, part in own.items()
        if not callable(part) and inspect.getdoc(part) and name not in {row[0] for row in held}
    ]
    yield table(("property", "what it is"), worked)
    yield examples(thing)
    for name, part in own.items():
        if inspect.isfunction(part):
            yield from of_function(f"{thing.__name__}.{name}", part, "###")


def of_function(name: str, function: Any, level: str = "##") -> Iterator[str]:
    """A function: how it is called, what it takes, gives and raises."""
    told = parsed(function)
    bare = [
        one.replace(annotation=inspect.Parameter.empty)
        for one in inspect.signature(function).parameters.values()
        if one.name != "self"
    ]
    called = str(inspect.Signature(bare))
    yield f"{level} `{name}{called}`\n\n{prose(told)}\n"
    rows = [(param.arg_name, param.type_name, param.description) for param in told.params]
    yield table(("parameter", "type", "meaning"), rows)
    if told.returns:
        yield (
            f"Returns `{told.returns.type_name}`. {plain(told.returns.description)}".strip() + "\n"
        )
    for error in told.raises:
        yield f"Raises `{error.type_name}`: {lower(plain(error.description))}\n"
    yield examples(function)


def parsed(thing: Any) -> Docstring:
    """A docstring's parts."""
    return parse(inspect.getdoc(thing) or "", DocstringStyle.NUMPYDOC)


def prose(told: Docstring) -> str:
    """What a docstring says before its sections."""
    return plain("\n\n".join(filter(None, (told.short_description, told.long_description))))


def plain(text: str | None) -> str:
    """Text of a docstring as Markdown has it, a paragraph a line."""
    paragraphs = (" ".join(part.split()) for part in (text or "").split("\n\n"))
    return "\n\n".join(paragraphs).replace("``", "`")


def lower(text: str) -> str:
    """A sentence to go on with."""
    return text[:1].lower() + text[1:]


def table(head: tuple[str, ...], rows: list[tuple[str | None, ...]]) -> str:
    """A table with names in its first column; nothing where there are no rows."""
    if not rows:
        return ""
    lines = [f"| {' | '.join(head)} |", "|" + " --- |" * len(head)]
    for name, *cells in rows:
        told = (plain(cell).replace("\n\n", " ").replace("|", "\\|") for cell in cells)
        lines.append(f"| `{name}` | {' | '.join(told)} |")
    return "\n".join(lines) + "\n"


def examples(thing: Any) -> str:
    """What is shown, with what comes of it: a docstring's last section, as it stands."""
    shown = (inspect.getdoc(thing) or "").partition("Examples\n--------\n")[2]
    return f"```pycon\n{shown}\n```\n" if shown else ""


if __name__ == "__main__":
    (HERE / "api.md").write_text(document(), encoding="utf-8", newline="\n")
