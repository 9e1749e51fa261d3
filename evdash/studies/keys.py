"""What a study may vary: every key of `--set`, and those that change several values at once."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from statistics import fmean
from typing import Any

from evdash.domain.scenario import FIRST_ROW, Line, Node, Scenario
from evdash.errors import Fault, InputError
from evdash.files.overrides import Setting, apply_settings
from evdash.files.validate import Raw, validate
from evdash.files.wording import shown


@dataclass(frozen=True, slots=True)
class StudyKey:
    """A key of its own: what it means, its unit, a value that serves, and what it does.

    `form` shows it as it is written, parts to be filled in between angle brackets. `change`
    takes the scenario as plain data, the parts filled in and the value; it raises LookupError
    where the parts name nothing and ValueError where the value will not do.
    """

    form: str
    meaning: str
    unit: str
    allowed: str
    change: Callable[[Raw, str, Any], Raw]

    @property
    def fixed(self) -> str:
        """What every key of this form begins with."""
        return self.form.partition("<")[0]


def _number(value: object, low: float, high: float) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not low <= value <= high:
        raise ValueError
    return float(value)


def _prices(raw: Raw, change: Callable[[list[float]], list[float]]) -> Raw:
    """The energy prices of all intervals changed together."""
    prices = change([row["price_per_kwh"] for row in raw["profile"]])
    rows = zip(raw["profile"], prices, strict=True)
    return raw | {"profile": [row | {"price_per_kwh": price} for row, price in rows]}


def _price_spread(raw: Raw, _: str, value: Any) -> Raw:
    factor = _number(value, 0, 100)

    def spread(prices: list[float]) -> list[float]:
        mean = fmean(prices)
        return [mean + factor * (price - mean) for price in prices]

    return _prices(raw, spread)


def _price_factor(raw: Raw, _: str, value: Any) -> Raw:
    factor = _number(value, -100, 100)
    return _prices(raw, lambda prices: [factor * price for price in prices])


def _tariff_factor(raw: Raw, _: str, value: Any) -> Raw:
    factor = _number(value, 0, 100)
    options = [o | {"price_per_kwh": factor * o["price_per_kwh"]} for o in raw["option"]]
    return raw | {"option": options}


def _voltage_band(raw: Raw, _: str, value: Any) -> Raw:
    half_pu = _number(value, 0.001, 0.4)
    band = {"voltage_min_pu": 1 - half_pu, "voltage_max_pu": 1 + half_pu}
    return raw | {"feeder": raw["feeder"] | band}


def _line(raw: Raw, rest: str, value: Any) -> Raw:
    row_of = {id(row): n for n, row in enumerate(raw["lines"], start=FIRST_ROW)}

    def names(row: Raw) -> tuple[str, ...]:
        ends = row["from_node"], row["to_node"]
        return f"{ends[0]}-{ends[1]}", f"{ends[1]}-{ends[0]}", f"row {row_of[id(row)]}"

    return raw | {"lines": _cell(raw["lines"], names, _columns(Line), rest, value)}


def _node(raw: Raw, rest: str, value: Any) -> Raw:
    cells = _cell(raw["nodes"], lambda row: (row["node"],), _columns(Node), rest, value)
    return raw | {"nodes": cells}


NAMING = {"from_node", "to_node", "node"}


def _columns(record: type[Line] | type[Node]) -> list[str]:
    return [field for field in record.model_fields if field not in NAMING]


def _cell(
    rows: list[Raw],
    names: Callable[[Raw], tuple[str, ...]],
    columns: list[str],
    rest: str,
    value: Any,
) -> list[Raw]:
    """The rows with one cell exchanged, `rest` being a row's name, a dot and a column."""
    name, _, column = rest.rpartition(".")
    if column not in columns:
        raise LookupError(f"no column {column!r}; columns are {', '.join(columns)}")
    called = [row for row in rows if name in names(row)]
    if not called:
        known = ", ".join(names(row)[0] for row in rows)
        raise LookupError(f"nothing called {name!r}; there are {known}")
    if len(called) > 1:
        which = " or ".join(repr(names(row)[-1]) for row in called)
        raise LookupError(f"{len(called)} called {name!r}; should be {which}")
    cell = None if value == "" else value
    return [row | {column: cell} if name in names(row) else row for row in rows]


STUDY_KEYS: Mapping[str, StudyKey] = {
    key.fixed: key
    for key in (
        StudyKey(
            "line.<from>-<to>.<column>",
            "A cell of `lines.csv`, such as a transformer's rating: `line.633-634.rating_kva`; "
            '"" for none',
            "as in the table",
            "as the column allows",
            _line,
        ),
        StudyKey(
            "node.<node>.<column>",
            'A cell of `nodes.csv`, such as `node.671.load_kw`; "" for none',
            "as in the table",
            "as the column allows",
            _node,
        ),
        StudyKey(
            "price.spread",
            "Factor on how far each interval's energy price is from the day's mean",
            "",
            "0 to 100",
            _price_spread,
        ),
        StudyKey("price.factor", "Factor on every energy price", "", "-100 to 100", _price_factor),
        StudyKey(
            "tariff.factor",
            "Factor on what drivers pay, of every price option",
            "",
            "0 to 100",
            _tariff_factor,
        ),
        StudyKey(
            "voltage.band_pu",
            "Lowest and highest voltage allowed, as far below and above 1 pu",
            "pu",
            "0.001 to 0.4",
            _voltage_band,
        ),
    )
}


def with_settings(scenario: Scenario, settings: Mapping[str, object]) -> Scenario:
    """The scenario with settings laid over it in their order, validated like any other.

    Raises InputError with every fault.
    """
    raw: Raw = scenario.model_dump(exclude_none=False)
    faults: list[Fault] = []
    for key, value in settings.items():
        own = next((known for known in STUDY_KEYS.values() if key.startswith(known.fixed)), None)
        if own is None or (own.form == own.fixed and key != own.form):
            raw, wrong = apply_settings(raw, [Setting(key, value)])
            faults += [Fault(key, fault.found, fault.allowed) for fault in wrong]
            continue
        try:
            raw = own.change(raw, key.removeprefix(own.fixed), value)
        except LookupError as error:
            faults.append(Fault(key, f"{error.args[0]}", f"should be {own.form}"))
        except (ValueError, TypeError):
            faults.append(Fault(key, shown(value), f"should be {own.allowed} ({own.meaning})"))
    try:
        changed = validate(raw)
    except InputError as error:
        raise InputError([*faults, *error.faults]) from None
    if faults:
        raise InputError(faults)
    return changed
