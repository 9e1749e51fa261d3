"""The settings a person may change while a day runs: what they are, mean and may be.

Meaning, unit and bounds come from the fields' own declarations; nothing is retyped here.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from pydantic.fields import FieldInfo

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import PriceOption, ProfileRow, Scenario, Station
from evdash.domain.trace import Inputs, Network, Trace
from evdash.errors import Fault
from evdash.policies.registry import described
from evdash.ui.typed import read_within
from evdash.ui.words import clock, counted, decided_by, plain

NETWORK_NAMES: Mapping[Network, str] = {"lindistflow": "Linearised", "ac": "Full AC"}


@dataclass(frozen=True, slots=True)
class Control:
    """A number a person may change: its key in scenario.toml, short label, value and bounds."""

    key: str
    label: str
    value: float
    marks: tuple[object, ...]
    help: str

    @property
    def is_count(self) -> bool:
        return isinstance(self.value, int)

    def read(self, text: str) -> float | Fault:
        """The number that was typed, or what is wrong with it."""
        return read_within(self.label, text, self.marks, whole=self.is_count)


def control(key: str, label: str, field: FieldInfo, value: float) -> Control:
    """A control from its field's declaration."""
    return Control(
        key,
        f"{label}, {unit}" if (unit := unit_of(field)) and unit not in label.lower() else label,
        value,
        tuple(field.metadata),
        help_text(field),
    )


def unit_of(field: FieldInfo) -> str:
    """The unit a field declares, or nothing."""
    extra = field.json_schema_extra
    return str(extra.get("unit", "")) if isinstance(extra, dict) else ""


def help_text(field: FieldInfo) -> str:
    """What a field means, as its declaration says."""
    unit = unit_of(field)
    return plain(f"{field.description}{f', in {unit}' if unit else ''}.")


def arrival_controls(scenario: Scenario) -> list[Control]:
    """Seed and arrivals per day; none where arrivals were recorded."""
    known = scenario.arrivals
    if not isinstance(known, GeneratedArrivals):
        return []
    fields = GeneratedArrivals.model_fields
    return [
        control("arrivals.seed", "Arrival seed", fields["seed"], known.seed),
        control(
            "arrivals.vehicles_per_day",
            "Vehicles a day",
            fields["vehicles_per_day"],
            known.vehicles_per_day,
        ),
    ]


def charger_control(scenario: Scenario) -> Control:
    """How many chargers there are."""
    field = Station.model_fields["chargers"]
    return control("station.chargers", "Chargers", field, scenario.station.chargers)


def option_controls(scenario: Scenario) -> list[tuple[str, Control, Control]]:
    """Name, price and average power of every price option."""
    fields = PriceOption.model_fields
    return [
        (
            option.name,
            control(
                f"option.{option.name}.price_per_kwh",
                "price",
                fields["price_per_kwh"],
                option.price_per_kwh,
            ),
            control(
                f"option.{option.name}.average_kw",
                "average",
                fields["average_kw"],
                option.average_kw,
            ),
        )
        for option in scenario.option
    ]


def all_controls(scenario: Scenario) -> list[Control]:
    """Every number the page lets a person change."""
    options = [c for _, price, rate in option_controls(scenario) for c in (price, rate)]
    return [*arrival_controls(scenario), charger_control(scenario), *options]


def price_field() -> FieldInfo:
    """The declaration of the energy price."""
    return ProfileRow.model_fields["price_per_kwh"]


def curve_for(scenario: Scenario, source: Scenario) -> tuple[float, ...]:
    """The energy prices of another scenario, hour for hour of the clock."""
    by_clock = {
        (source.time_of(t).hour, source.time_of(t).minute): price
        for t, price in enumerate(source.price_per_kwh.tolist())
    }
    by_hour = {hour: price for (hour, minute), price in sorted(by_clock.items()) if minute == 0}
    prices = []
    for t, own in enumerate(scenario.price_per_kwh.tolist()):
        moment = scenario.time_of(t)
        exact = by_clock.get((moment.hour, moment.minute))
        prices.append(by_hour.get(moment.hour, own) if exact is None else exact)
    return tuple(prices)


def prices_from_now(trace: Trace, prices: tuple[float, ...]) -> tuple[float, ...]:
    """Energy prices with those of the past as they were; all new for a day that is over."""
    if trace.is_over:
        return prices
    past = trace.scenario.price_per_kwh[: trace.now].tolist()
    return (*past, *prices[trace.now :])


def changes(before: Scenario, after: Scenario, first: int = 0) -> list[str]:
    """What differs between two scenarios from interval `first` on, in words."""
    old, new = _values(before), _values(after)
    told = [
        f"{plain(label)} {old[key][1]:g} → {value:g}"
        for key, (label, value) in new.items()
        if key in old and old[key][1] != value
    ]
    was, now = before.price_per_kwh[first:], after.price_per_kwh[first:]
    differing = int((was != now).sum()) if len(was) == len(now) else len(now)
    if differing:
        told.append(f"energy price of {counted(differing, 'interval')}")
    return told


def setting_labels(scenario: Scenario) -> dict[str, str]:
    """Every setting as it is called where no heading says whose it is, by its key."""
    return {key: label for key, (label, _) in _values(scenario).items()}


def settings_told(trace: Trace) -> str:
    """All settings in force in a line, for paper, which has no sidebar."""
    inputs, who = trace.inputs, decided_by(trace.policy)
    told = [plain(inputs.scenario.name)]
    if described(trace.policy).keeps_limits:
        told.append(f"limits kept in {NETWORK_NAMES[inputs.network]}")
    told += [who] * bool(who)
    told += [f"{plain(label)} {value:g}" for label, value in _values(inputs.scenario).values()]
    return " · ".join(told)


def _values(scenario: Scenario) -> Mapping[str, tuple[str, float]]:
    named = [*arrival_controls(scenario), charger_control(scenario)]
    values = {c.key: (c.label, c.value) for c in named}
    if isinstance(scenario.arrivals, GeneratedArrivals):
        for name, share in scenario.arrivals.option_share.items():
            values[f"share.{name}"] = (f"drivers who choose {name}, %", 100 * share)
    for name, price, rate in option_controls(scenario):
        values |= {c.key: (f"{name} {c.label}", c.value) for c in (price, rate)}
    return values


def edit_log(trace: Trace, opened: Scenario, outlook: Outlook) -> list[str]:
    """What was changed and since when, read off the inputs in force at every step; what is to come.

    That is an event foreseen, of which the station does not know yet.
    """
    told = []
    before, network = opened, next(iter(NETWORK_NAMES))
    moments: list[tuple[int, Inputs]] = [(step.interval, step.inputs) for step in trace.steps]
    for interval, inputs in [*moments, (trace.now, trace.inputs)]:
        over = interval >= outlook.n_intervals
        what = []
        if inputs.scenario is not before:
            what = changes(before, inputs.scenario, 0 if over else interval)
        if inputs.network != network:
            what.append(f"limits kept in {NETWORK_NAMES[inputs.network]}")
        if what:
            since = f"from {clock(outlook.times[interval], outlook)}"
            told.append(f"**{'for the next run' if over else since}:** {'; '.join(what)}")
        before, network = inputs.scenario, inputs.network

    def at(interval: int) -> str:
        return clock(outlook.times[interval], outlook)

    if not trace.is_over:
        told += [
            f"**at {at(event.interval)}:** {plain(event.told(at))}"
            for event in trace.inputs.given.events
            if event not in opened.events and event.interval > trace.now
        ]
    return told
