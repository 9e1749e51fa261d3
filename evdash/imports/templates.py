"""Templates to write one's own data over: small, complete, and valid as they are.

What stands in them lies in `data/templates`; what each column means, its unit and what it allows
comes from the fields' own declarations.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from evdash.domain.arrivals import GeneratedArrivals, RecordedArrivals
from evdash.domain.scenario import Feeder, PriceOption, Scenario, Station
from evdash.errors import Fault, InputError
from evdash.files.draft import RECORDS, Draft, read_draft
from evdash.files.exchange import put_files
from evdash.files.folder import read_files
from evdash.files.wording import allowed_words
from evdash.imports.scenario_book import (
    KEY,
    NOTES_SHEET,
    SETTINGS_SHEET,
    SHEETS,
    VALUE,
    settings_rows,
    table_rows,
)
from evdash.imports.workbook import is_workbook, written
from evdash.resources import DATA

FOLDER = DATA / "templates"
TABLES: Mapping[str, str] = {
    "sessions.csv": "recorded sessions, for `import sessions`",
    "prices.csv": "energy prices by date and time, for `import prices`",
    "loads.csv": "loads and generation by date and time, for `import loads`",
}
"""Tables beside the scenario, and what each is for."""
WORKBOOK = "scenario.xlsx"
HEAD = ("Where", "Name", "Meaning", "Unit", "Allowed", "Must be given")
TABLES_OF_SCENARIO = ("option", "arrivals", "feeder", "station", *SHEETS)


def template_draft() -> Draft:
    """The scenario of the template."""
    return read_draft(read_files(FOLDER / "scenario"))


def template_table(name: str) -> bytes:
    """One of TABLES."""
    return (FOLDER / name).read_bytes()


def template_workbook() -> bytes:
    """The scenario as a workbook: every sheet there can be, notes at the heads, a README."""
    draft = template_draft()
    every_field = [*field_rows()]
    known = {(where, name): told for where, name, *told in every_field}
    settings: list[list[object]] = [[KEY, VALUE, "meaning", "unit", "allowed"]]
    for key, value in settings_rows(draft.settings):
        settings.append([key, value, *known.get((SETTINGS_SHEET, _general(str(key))), [""])[:3]])
    sheets: dict[str, list[list[object]]] = {
        NOTES_SHEET: [[*HEAD], *map(_cells, every_field)],
        SETTINGS_SHEET: settings,
    }
    notes: dict[str, dict[str, str]] = {}
    for sheet, file in SHEETS.items():
        sheets[sheet] = table_rows(file, draft.tables.get(file, ()))
        columns = RECORDS[file].model_fields
        notes[sheet] = {column: _note(known[sheet, column]) for column in columns}
    return written(sheets, notes)


def _cells(row: Sequence[str]) -> list[object]:
    return list(row)


def _general(key: str) -> str:
    """A key with NAME for an option's name, as it stands in the README."""
    parts = key.split(".")
    return f"option.NAME.{parts[-1]}" if parts[0] == "option" else key


def _note(told: list[str]) -> str:
    meaning, unit, allowed, must = told
    return ". ".join(
        part
        for part in (
            meaning,
            f"Unit: {unit}" if unit else "",
            f"Allowed: {allowed}" if allowed else "",
            "Must be given" if must == "yes" else "May be blank",
        )
        if part
    )


def field_rows() -> Iterator[tuple[str, ...]]:
    """Every key and column there is: where, name, meaning, unit, allowed, must be given."""
    named: list[tuple[str, str, type[BaseModel]]] = [
        (SETTINGS_SHEET, "", Scenario),
        (SETTINGS_SHEET, "feeder.", Feeder),
        (SETTINGS_SHEET, "station.", Station),
        (SETTINGS_SHEET, "option.NAME.", PriceOption),
        (SETTINGS_SHEET, "arrivals.", GeneratedArrivals),
        *((sheet, "", RECORDS[file]) for sheet, file in SHEETS.items()),
    ]
    for where, prefix, record in named:
        if record is GeneratedArrivals:
            told = "Where vehicles come from a list: arrivals.csv. Else the keys below"
            yield (where, "arrivals.file", told, "", "arrivals.csv", "no")
        for name, field in record.model_fields.items():
            if record in (Scenario, RecordedArrivals) and name in TABLES_OF_SCENARIO:
                continue
            if record is PriceOption and name == "name":
                continue
            if record is GeneratedArrivals and name == "fleet":
                yield (where, "arrivals.fleet", "Models drawn from: fleet.csv", "", "", "no")
                continue
            yield (where, f"{prefix}{name}", *_told(field, record is GeneratedArrivals))


def _told(field: FieldInfo, is_alternative: bool) -> tuple[str, str, str, str]:
    extra = field.json_schema_extra
    unit = str(extra.get("unit") or "") if isinstance(extra, dict) else ""
    must = field.is_required() and not is_alternative
    return str(field.description), unit, allowed_words(field), "yes" if must else "no"


def template_files() -> dict[str, bytes]:
    """Every template by its path: workbook, scenario folder, tables, and what is what."""
    folder = read_files(FOLDER / "scenario")
    return {
        "README.md": _readme().encode(),
        WORKBOOK: template_workbook(),
        **{f"scenario/{name}": content for name, content in folder.items()},
        **{name: template_table(name) for name in TABLES},
    }


def _readme() -> str:
    rows = ["| " + " | ".join(HEAD) + " |", "|" + " --- |" * len(HEAD)]
    rows += [
        "| " + " | ".join(cell.replace("|", "\\|") for cell in row) + " |" for row in field_rows()
    ]
    tables = [f"- `{name}`: {told}" for name, told in TABLES.items()]
    return "\n".join(
        [
            "# Templates",
            "",
            "Each is complete and runs as it is; write your own data over it.",
            "",
            "- `scenario/`: a scenario folder, for `python -m evdash run`",
            f"- `{WORKBOOK}`: the same as a workbook, for `import workbook`",
            *tables,
            "",
            "The Scenario page takes all of them. Every key and column:",
            "",
            *rows,
            "",
        ]
    )


def write_templates(where: Path, force: bool) -> list[Path]:
    """Write the workbook to a name that ends on .xlsx, else every template into a folder.

    InputError, and nothing written, where files are there already and `force` is not set.
    """
    files = {Path(name): content for name, content in template_files().items()}
    if is_workbook(where.name):
        targets = {where: files[Path(WORKBOOK)]}
    else:
        targets = {where / name: content for name, content in files.items()}
    there = [path for path in targets if path.exists()]
    if there and not force:
        rule = "add --force to replace them, or name another place"
        raise InputError([Fault(str(path), "a file that is there already", rule) for path in there])
    put_files(targets)
    return list(targets)
