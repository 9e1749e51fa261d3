"""A scenario in the making: the contents of its files, right or wrong.

A draft holds whatever was typed or uploaded, so that no work is lost to a fault. It is checked
as the files it stands for: the same door, the same faults, rows counted as in those files.
"""

import io
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import tomlkit
from pydantic import BaseModel

from evdash.domain.arrivals import Arrival, ArrivalStatistics, FleetModel
from evdash.domain.events import Event
from evdash.domain.scenario import Line, Node, ProfileRow, Scenario
from evdash.errors import Fault, InputError
from evdash.files.nested import read_toml
from evdash.files.scenario_folder import SETTINGS, parse_scenario, resolved, scenario_files
from evdash.files.tables import decode, read_table, write_table
from evdash.files.validate import Raw
from evdash.horizon.arrivals import arrivals_of

RECORDS: Mapping[str, type[BaseModel]] = {
    "nodes.csv": Node,
    "lines.csv": Line,
    "profile.csv": ProfileRow,
    "fleet.csv": FleetModel,
    "arrivals.csv": Arrival,
    "events.csv": Event,
}
"""The tables of a scenario folder by the names this program writes them under."""
ZIP_TIME = (1980, 1, 1, 0, 0, 0)
"""The earliest a .zip can say, so that the same files give the same bytes."""

Row = dict[str, str]
Rows = tuple[Row, ...]


@dataclass(frozen=True, slots=True)
class Draft:
    """`settings`: scenario.toml as nested tables. `tables`: rows of text by file, "" for blank."""

    settings: Raw
    tables: Mapping[str, Rows]

    @property
    def is_recorded(self) -> bool:
        """Whether vehicles come from a list and are not drawn at random."""
        return "file" in self.arrivals

    @property
    def arrivals(self) -> Raw:
        """The `[arrivals]` table; empty where there is none to speak of."""
        arrivals = self.settings.get("arrivals")
        return arrivals if isinstance(arrivals, dict) else {}

    def with_settings(self, settings: Raw) -> "Draft":
        """The draft under another scenario.toml."""
        return replace(self, settings=settings)

    def with_table(self, file: str, rows: Rows) -> "Draft":
        """The draft with one table exchanged."""
        return replace(self, tables={**self.tables, file: rows})


def draft_of(scenario: Scenario) -> Draft:
    """The draft of a valid scenario."""
    return read_draft({name: text.encode() for name, text in scenario_files(scenario).items()})


def read_draft(files: Mapping[str, bytes]) -> Draft:
    """The draft that files hold, faulty values and all.

    Raises InputError where the files cannot be taken as a scenario's at all: text that is not
    TOML or CSV, columns that are missing or unknown, files nothing refers to.
    """
    settings, faults = (
        read_settings(files[SETTINGS])
        if SETTINGS in files
        else ({}, [Fault(SETTINGS, "no such file", "should be there")])
    )
    usual = _usual_names(settings)
    tables = {}
    for name, content in files.items():
        file = usual.get(name, name)
        if file in RECORDS:
            tables[file], found = read_rows(file, content)
            faults += found
        elif name not in (SETTINGS, "README.md"):
            known = f"the files are {', '.join([SETTINGS, *RECORDS])}"
            faults.append(Fault(name, "a file that is not part of a scenario", known))
    if faults:
        raise InputError(faults)
    return Draft(_with_usual_names(settings), tables)


def read_settings(content: bytes) -> tuple[Raw, list[Fault]]:
    """A scenario.toml as nested tables, or why it is none."""
    text, faults = decode(SETTINGS, content)
    if faults:
        return {}, faults
    try:
        return read_toml(text), []
    except ValueError as error:
        return {}, [Fault(SETTINGS, f"text that is not TOML ({error})", "should be TOML")]


def read_rows(file: str, content: bytes) -> tuple[Rows, list[Fault]]:
    """The rows of a table with every column of its record, or why it is none."""
    record = RECORDS[file]
    table, faults = read_table(file, content, record)
    if table is None:
        return (), faults
    columns = list(record.model_fields)
    return tuple({c: str(row.get(c, "")).strip() for c in columns} for row in table.rows), []


def table_for(name: str, content: bytes) -> str | None:
    """Which table an uploaded file is: by its name, else by its columns; None if neither says."""
    stem = name.lower().removesuffix(".csv")
    for file in RECORDS:
        known = file.removesuffix(".csv")
        if stem == known or stem.startswith((f"{known} ", f"{known}(", f"{known}-", f"{known}_")):
            return file
    matching = [file for file in RECORDS if not read_rows(file, content)[1]]
    return matching[0] if len(matching) == 1 else None


def _usual_names(settings: Raw) -> dict[str, str]:
    """What this program calls the tables that settings name: their name to ours."""
    arrivals = settings.get("arrivals")
    if not isinstance(arrivals, dict):
        return {}
    forecast = arrivals.get("forecast")
    named = [
        (arrivals.get("file"), "arrivals.csv"),
        (arrivals.get("fleet"), "fleet.csv"),
        (forecast.get("fleet") if isinstance(forecast, dict) else None, "fleet.csv"),
    ]
    return {name: usual for name, usual in named if isinstance(name, str)}


def _with_usual_names(settings: Raw) -> Raw:
    usual = _usual_names(settings)

    def renamed(table: Raw) -> Raw:
        return {
            key: usual[value] if key in ("file", "fleet") and isinstance(value, str) else value
            for key, value in table.items()
        }

    arrivals = settings.get("arrivals")
    if not isinstance(arrivals, dict):
        return settings
    named = renamed(arrivals)
    if isinstance(named.get("forecast"), dict):
        named["forecast"] = renamed(named["forecast"])
    return settings | {"arrivals": named}


def files_of(draft: Draft) -> dict[str, str]:
    """The files a draft stands for: those its settings refer to."""
    arrivals = draft.arrivals
    wanted = {"nodes.csv", "lines.csv", "profile.csv"}
    if draft.is_recorded:
        wanted.add("arrivals.csv")
    if draft.tables.get("events.csv"):
        wanted.add("events.csv")
    statistics = arrivals.get("forecast") if draft.is_recorded else arrivals
    if isinstance(statistics, dict):
        wanted.add("fleet.csv")
    return {SETTINGS: settings_text(draft.settings)} | {
        file: table_text(file, draft.tables.get(file, ())) for file in RECORDS if file in wanted
    }


def settings_text(settings: Raw) -> str:
    """Settings as the text of a scenario.toml; plain values before tables, as TOML wants."""
    ordered = {k: v for k, v in settings.items() if not _is_table(v)}
    ordered |= {k: v for k, v in settings.items() if _is_table(v)}
    return tomlkit.dumps(ordered)


def _is_table(value: Any) -> bool:
    return isinstance(value, dict) or (
        isinstance(value, list) and bool(value) and all(isinstance(part, dict) for part in value)
    )


def table_text(file: str, rows: Sequence[Row]) -> str:
    """Rows as the text of a CSV file."""
    columns = list(RECORDS[file].model_fields)
    return write_table(columns, ([row[column] for column in columns] for row in rows))


def template_text(file: str) -> str:
    """A table to fill in: its columns and one row of examples."""
    record = RECORDS[file]
    examples = [field.examples[0] for field in record.model_fields.values() if field.examples]
    cells = [v.strftime("%H:%M") if hasattr(v, "strftime") else v for v in examples]
    return write_table(list(record.model_fields), [cells])


def scenario_of(draft: Draft) -> Scenario:
    """The scenario a draft stands for; raises InputError with every fault."""
    return parse_scenario({name: text.encode() for name, text in files_of(draft).items()})


def listed(draft: Draft) -> Draft:
    """The draft with the vehicles it would draw as a list; raises InputError if it is faulty."""
    scenario = scenario_of(draft)
    return draft_of(resolved(scenario, arrivals_of(scenario)))


def recorded(draft: Draft) -> tuple[Draft, list[str]]:
    """The draft with the vehicles of its arrivals.csv where it would draw them, and that it has;
    what they were drawn by becomes the forecast."""
    if draft.is_recorded or not draft.tables.get("arrivals.csv"):
        return draft, []
    statistics = {key: value for key, value in draft.arrivals.items() if key != "seed"}
    settings: Raw = {"file": "arrivals.csv"}
    settings |= {key: value for key, value in draft.arrivals.items() if key == "seed"}
    settings |= {"forecast": statistics} if statistics else {}
    told = ["Vehicles come from arrivals.csv now; what they were drawn by is kept as forecast."]
    return draft.with_settings(draft.settings | {"arrivals": settings}), told


def drawn(draft: Draft, statistics_from: Scenario) -> Draft:
    """The draft with vehicles drawn at random: by its own forecast, else by another's statistics.

    Options the statistics do not know share equally.
    """
    arrivals = draft.arrivals
    forecast = arrivals.get("forecast")
    other = draft_of(statistics_from)
    seed = {"seed": arrivals.get("seed", 1)}
    if isinstance(forecast, dict):
        return draft.with_settings(draft.settings | {"arrivals": forecast | seed})
    options = [o.get("name") for o in draft.settings.get("option", []) if isinstance(o, dict)]
    statistics = {
        key: value for key, value in other.arrivals.items() if key in ArrivalStatistics.model_fields
    }
    if set(statistics["option_share"]) != set(options):
        statistics["option_share"] = {str(name): 1 / len(options) for name in options}
    settings = draft.settings | {"arrivals": statistics | seed}
    return draft.with_settings(settings).with_table("fleet.csv", other.tables["fleet.csv"])


def zipped(files: Mapping[str, str | bytes], folder: str = "scenario") -> bytes:
    """Files as a .zip of one folder; the same files always give the same bytes."""
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            entry = zipfile.ZipInfo(f"{folder}/{name}", ZIP_TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            archive.writestr(entry, content.encode() if isinstance(content, str) else content)
    return target.getvalue()
