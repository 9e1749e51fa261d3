"""Writes `docs/scenario.md` from the declarations of the fields.

Run `python docs/build_scenario_doc.py` after changing a field; a test holds both in step.
"""

import sys
from pathlib import Path

from pydantic import BaseModel
from pydantic.fields import FieldInfo

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from evdash.domain.arrivals import Arrival, FleetModel, GeneratedArrivals  # noqa: E402
from evdash.domain.events import EVENT_FORMS, Event  # noqa: E402 - the path above makes it so
from evdash.domain.fields import LARGE  # noqa: E402
from evdash.domain.refusal import CLAUSES  # noqa: E402
from evdash.domain.scenario import (  # noqa: E402
    Feeder,
    Line,
    Node,
    PriceOption,
    ProfileRow,
    Scenario,
    Station,
)
from evdash.files.run_tables import RUN_TABLES  # noqa: E402

INTRODUCTION = """\
# Scenario folders and run folders

Written by `docs/build_scenario_doc.py` from the declarations in `evdash/domain/scenario.py`,
`evdash/domain/arrivals.py` and `evdash/files/run_tables.py`.

A scenario is a folder, or a `.zip` of one, with `scenario.toml` and the CSV tables below: UTF-8,
comma-separated, with a header. A blank cell means none; a column that may be blank may be left
out. Unknown keys, columns and files are faults, a `README.md` apart. Names of nodes, vehicles
and options are text, begin with a letter or digit, and are never numbers. Times are local, with
neither time zone nor clock change. `data/presets/` holds complete examples.
"""

SECTIONS: tuple[tuple[str, str, type[BaseModel]], ...] = (
    ("`scenario.toml`", "Keys at the top.", Scenario),
    ("`[feeder]`", "", Feeder),
    ("`[station]`", "", Station),
    ("`[[option]]`", "One for each price option.", PriceOption),
    (
        "`[arrivals]`, drawn at random",
        "With `fleet` the name of a file, `fleet.csv`. For arrivals on file write "
        '`file = "arrivals.csv"` instead, with `seed` if a policy samples, and, if a policy may '
        "know the statistics, the keys below but the seed in `[arrivals.forecast]`. The number "
        "arriving is Poisson by clock hour; minutes are uniform within the hour; each interval "
        "has a random stream of its own.",
        GeneratedArrivals,
    ),
    ("`nodes.csv`", "", Node),
    (
        "`lines.csv`",
        "A transformer is such a row, in ohms at base_kv. In the linearised model what flows is "
        "the lossless sum of what lies downstream.",
        Line,
    ),
    ("`profile.csv`", "One row for each interval.", ProfileRow),
    (
        "`arrivals.csv`",
        "A vehicle arriving between two intervals takes part from the next.",
        Arrival,
    ),
    ("`fleet.csv`", "", FleetModel),
    (
        "`events.csv`",
        "Optional: what happens on the way. An event is known at the start of its interval and "
        "never before; from then on the inputs in force are others. Events of one interval count "
        "together. [reliability.md](reliability.md) says how promises fare.",
        Event,
    ),
)
EVENTS_TOLD = """\
A vehicle's events concern its contract while that is open: on one who has not come yet, was
refused, or has got all its energy, they have no effect. Where arrivals are drawn, vehicles are
named PEV-001, PEV-002 and so on, and not each of them comes on every day. What a driver gives up
by leaving early, being late or staying away is `released` and not a broken promise, and costs
nobody else anything. More energy is granted as far as every promise leaves room and the battery
can take it.
"""
RUN_INTRODUCTION = """\
# What a run writes

`python -m evdash run --out DIR` writes these tables in full precision, `summary.json` with the
totals, verdicts, versions, seed, policy, network model and the scenario's SHA-256, and
`scenario/`, the complete scenario with the arrivals that were drawn, to be run and audited
anywhere. `python -m evdash audit DIR` works it out again by other means, and names what it cannot:
[reliability.md](reliability.md) has the table.

DIR, through links if it is one, must be new, empty, or an earlier run's and then `--force` be
given: those of its files that a run writes change for the new ones all at once, and what else
lies there stays. It is claimed before the day is run, so that two runs cannot end in one folder.
Interrupted, the earlier run is put back; if the process is killed, by the next run that is to
write there. Nothing is written inside a scenario's folder, which could not be read with other
files in it.
"""


def bounds(field: FieldInfo) -> str:
    """What a field allows, in words."""
    words = {"Ge": "≥ ", "Gt": "> ", "Le": "≤ ", "Lt": "< "}
    told = [
        f"{words[type(rule).__name__]}{getattr(rule, type(rule).__name__.lower()):,.10g}"
        for rule in field.metadata
        if type(rule).__name__ in words
    ]
    return ", ".join(told)


def section(record: type[BaseModel]) -> str:
    """A record's fields as a table."""
    lines = [
        "| field | meaning | unit | allowed | must be given |",
        "| --- | --- | --- | --- | --- |",
    ]
    for name, field in record.model_fields.items():
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        if field.description and not (record is Scenario and name in TABLES_OF_SCENARIO):
            need = "yes" if field.is_required() else "no"
            meaning = field.description.replace("|", "\\|")
            unit = extra.get("unit", "")
            lines.append(f"| `{name}` | {meaning} | {unit} | {bounds(field)} | {need} |")
    return "\n".join(lines)


def event_kinds() -> str:
    """What each kind of event means and which cells its row has."""
    lines = [
        "| event | meaning | subject | value | from_interval, until_interval |",
        "| --- | --- | --- | --- | --- |",
    ]
    for kind, form in EVENT_FORMS.items():
        upper = f" to {form.most:,.10g}" if form.most < LARGE else ""
        value = f"{form.value}, {form.least:,.10g}{upper}" if form.value and upper else form.value
        need = "" if form.span_required else " may be given"
        span = " and ".join(f"`{edge}`" for edge in form.span) + (need if form.span else "")
        lines.append(f"| `{kind}` | {form.meaning} | {form.subject} | {value} | {span} |")
    return "\n".join(lines)


def reasons() -> str:
    """Every reason for which a vehicle is refused."""
    told = (f"- {clause}" for kind, clause in CLAUSES.items() if kind != "as told")
    return "\n".join([REASONS_TOLD, *told, ""])


REASONS_TOLD = """\
`reason` is blank, or one of these, followed where there is more to say by a colon and its figures,
names or elements. The same words stand on the pages, in reports, races and explanations.
[equations.md](equations.md) says how each is found.
"""
TABLES_OF_SCENARIO = ("option", "nodes", "lines", "profile", "events")


def document() -> str:
    """The whole page."""
    parts = [INTRODUCTION]
    for title, told, record in SECTIONS:
        parts.append(f"## {title}\n")
        if told:
            parts.append(told + "\n")
        parts.append(section(record) + "\n")
    parts.append(event_kinds() + "\n")
    parts.append(EVENTS_TOLD)
    parts.append(RUN_INTRODUCTION)
    for title, record in RUN_TABLES.items():
        parts.append(f"## `{title}`\n\n{section(record)}\n")
        if title == "vehicles.csv":
            parts.append(reasons())
    return "\n".join(parts)


if __name__ == "__main__":
    (HERE / "scenario.md").write_text(document(), encoding="utf-8", newline="\n")
