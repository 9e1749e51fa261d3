"""pandapower's JSON read as plain data.

pandapower's own reader makes objects of whatever class a file names. Here nothing is made of a
file but lists, texts and numbers; of these the known tables are checked row by row, and no other
is looked into beyond whether it has elements in service.
"""

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from evdash.errors import Fault, InputError
from evdash.files.nested import read_json
from evdash.files.wording import allowed, found, shown
from evdash.grid.nets.records import LARGEST, RECORDS, SMALLEST, Element, Net, Other

MAX_BYTES = 32 * 1024 * 1024
MAX_LISTS, MAX_VALUES = 1_000_000, 5_000_000
"""What JSON may hold: as objects it is many times the size of its text."""
MAX_ROWS = 20_000
MAX_FAULTS = 100
FORM = "should be a network as pandapower.to_json writes it"
NO_ELEMENTS = {"measurement", "pwl_cost", "poly_cost", "controller", "group", "bus_geodata"}
"""Tables that say nothing about what a power flow of the file as it stands computes."""
PLACES = {"bus", "from_bus", "hv_bus", "bus_dc", "from_bus_dc"}
"""Columns by which a table is known to hold elements of a network."""

LIMIT_BEGINS = ("max_", "min_")
LIMITS = {"in_ka", "rating_kva"}
NO_LIMITS = {"max_step", "max_e_mwh", "min_e_mwh"}
"""Columns named like limits: what a shunt could be switched to, what a storage could hold."""


def is_pandapower(data: object) -> bool:
    """Whether decoded JSON has the outer form of a pandapower network."""
    return isinstance(data, dict) and isinstance(_content(data).get("bus"), dict)


def read_net(name: str, content: bytes) -> tuple[Net, tuple[str, ...]]:
    """The network in a file and what of the file was not looked at; InputError with every fault."""
    data = decoded_json(name, content)
    if not is_pandapower(data):
        raise InputError([Fault(name, "JSON that is no network with a table bus", FORM)])
    return _Reader(name, _content(data)).net()


def decoded_json(name: str, content: bytes, most_bytes: int = MAX_BYTES) -> Any:
    """JSON as plain data; InputError where it is none or too large."""
    if len(content) > most_bytes:
        size = f"{len(content) / 2**20:.1f} MiB"
        raise InputError([Fault(name, size, f"at most {most_bytes // 2**20} MiB")])
    lists = content.count(b"[") + content.count(b"{")
    values = lists + content.count(b",") + content.count(b":")
    if lists > MAX_LISTS or values > MAX_VALUES:
        found = f"{lists:,} lists and objects, {values:,} values"
        raise InputError([Fault(name, found, f"at most {MAX_LISTS:,} and {MAX_VALUES:,}")])
    try:
        return read_json(content.decode("utf-8-sig"))
    except ValueError as error:
        raise InputError([Fault(name, f"text that is not JSON ({error})", FORM)]) from error


def _content(data: Any) -> dict[str, Any]:
    inner = data.get("_object") if isinstance(data, dict) else None
    return inner if isinstance(inner, dict) else data if isinstance(data, dict) else {}


class _Reader:
    """Gathers the tables of a network and every fault in them."""

    def __init__(self, name: str, content: Mapping[str, Any]) -> None:
        self.name = name
        self.content = content
        self.faults: list[Fault] = []

    def net(self) -> tuple[Net, tuple[str, ...]]:
        tables = {table: self._records(table) for table in RECORDS}
        if not tables["bus"] and not self.faults:
            self._fault("table bus", "no rows", "should have the network's buses")
        others, notices = self._others()
        numbers = {key: self._number(key, default) for key, default in _SETTINGS.items()}
        if self.faults:
            raise InputError(list(dict.fromkeys(self.faults))[:MAX_FAULTS])
        title = self.content.get("name")
        named = title if isinstance(title, str) and title.strip() else self.name
        parts: dict[str, Any] = {"name": named[:200], "others": others}
        net = Net.model_validate(parts | numbers | tables)
        return net, notices

    def _fault(self, place: str, value: str, rule: str) -> None:
        self.faults.append(Fault(f"{self.name}, {place}", value, rule))

    def _number(self, key: str, default: float) -> float:
        value = self.content.get(key, default)
        if (
            isinstance(value, bool)
            or not isinstance(value, int | float)
            or not (SMALLEST <= value < 1e6)
        ):
            self._fault(key, shown(value), f"should be a number from {SMALLEST} to 1,000,000")
            return default
        return float(value)

    def _records(self, table: str) -> tuple[Element, ...]:
        rows, columns = self._rows(table)
        kind = RECORDS[table]
        read = []
        for index, row in rows:
            try:
                read.append(kind.model_validate(_prepared(table, row, columns) | {"index": index}))
            except ValidationError as error:
                for details in error.errors(include_url=False):
                    column = str(details["loc"][0])
                    place = f"table {table}, row {index}, column {column}"
                    self._fault(place, found(details), allowed(details))
        for index, count in Counter(index for index, _ in rows).items():
            if count > 1:
                self._fault(f"table {table}", f"row {index} more than once", "each index once")
        return tuple(read)

    def _rows(self, table: str) -> tuple[list[tuple[int, dict[str, Any]]], list[str]]:
        """Rows of a table by index, as plain cells; none where it is not there or no table."""
        raw = self.content.get(table)
        if raw is None:
            return [], []
        place = f"table {table}"
        data = _frame(raw)
        if data is None:
            self._fault(place, shown(raw), "should be a table of columns, index and data")
            return [], []
        columns, index, cells = data["columns"], data["index"], data["data"]
        if len(cells) > MAX_ROWS:
            self._fault(place, f"{len(cells):,} rows", f"at most {MAX_ROWS:,}")
            return [], []
        if len(index) != len(cells):
            self._fault(place, f"{len(index)} indices of {len(cells)} rows", "one for each")
            return [], []
        rows = []
        for key, row in zip(index, cells, strict=True):
            if isinstance(key, bool) or not isinstance(key, int):
                self._fault(place, f"index {shown(key)}", "should be a whole number")
            elif not isinstance(row, list) or len(row) != len(columns):
                self._fault(f"{place}, row {key}", "a row of another length", "as many as columns")
            else:
                rows.append((key, dict(zip(columns, row, strict=True))))
        return rows, columns

    def _others(self) -> tuple[tuple[Other, ...], tuple[str, ...]]:
        """Elements of kinds that are not read, and the tables nothing was read of."""
        others, unread = [], []
        for table, raw in self.content.items():
            is_result = table.startswith(("res_", "_"))
            if table in RECORDS or is_result or _frame(raw) is None:
                continue
            rows, columns = self._rows(table)
            if not rows:
                continue
            if table in NO_ELEMENTS or not PLACES & set(columns):
                unread.append(f"{table} ({len(rows)} rows)")
                continue
            for index, row in rows:
                live = row.get("in_service")
                others.append(
                    Other(
                        index=index,
                        name=row.get("name") if isinstance(row.get("name"), str) else None,
                        in_service=live if isinstance(live, bool) else True,
                        table=table,
                    )
                )
        told = (f"Not read, as no power flow needs them: {', '.join(unread)}.",) if unread else ()
        return tuple(others), told


_SETTINGS = {"f_hz": 50.0, "sn_mva": 1.0}


def _frame(raw: Any) -> dict[str, list[Any]] | None:
    """A table in pandas' `split` form, written as an object or as text within the JSON."""
    data = raw
    if isinstance(raw, dict) and "_object" in raw:
        if raw.get("_class") != "DataFrame" or raw.get("orient", "split") != "split":
            return None
        data = raw["_object"]
        if isinstance(data, str):
            try:
                data = read_json(data)
            except ValueError:
                return None
    if not isinstance(data, dict):
        return None
    parts = [data.get(key) for key in ("columns", "index", "data")]
    if not all(isinstance(part, list) for part in parts):
        return None
    if not all(isinstance(column, str) for column in data["columns"]):
        return None
    return data


def _prepared(table: str, row: dict[str, Any], columns: list[str]) -> dict[str, Any]:
    """A row with columns of older forms under their present names, blanks left to defaults."""
    cells = {key: value for key, value in row.items() if value is not None}
    cells["unheld"] = _unheld(table, cells)
    if table == "bus":
        cells |= _position(cells.get("geo"))
    if table == "trafo" and "tap_changer_type" not in columns:  # before pandapower 3
        cells["tap_changer_type"] = "Ideal" if cells.get("tap_phase_shifter") else "Ratio"
    if table == "load":
        for part in ("z", "i"):
            if f"const_{part}_percent" in cells:
                old = cells[f"const_{part}_percent"]
                cells.setdefault(f"const_{part}_p_percent", old)
                cells.setdefault(f"const_{part}_q_percent", old)
    return cells


def _unheld(table: str, cells: Mapping[str, object]) -> dict[str, float]:
    """What a row limits by columns that no scenario has a place for."""
    return {
        column: float(value)
        for column, value in cells.items()
        if (column.startswith(LIMIT_BEGINS) or column in LIMITS)
        and column not in NO_LIMITS
        and column not in RECORDS[table].model_fields
        and isinstance(value, int | float)
        and not isinstance(value, bool)
        and math.isfinite(value)
        and abs(value) < LARGEST
    }


def _position(geo: object) -> dict[str, float]:
    """Drawing position from a GeoJSON point; none where it is anything else."""
    try:
        point = read_json(geo) if isinstance(geo, str) else {}
        x, y = point["coordinates"][:2]
        return {"x": float(x), "y": float(y)}
    except (ValueError, TypeError, KeyError):
        return {}
