"""Questions a planner asks, each made into a study of the scenario at hand."""

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.scenario import Scenario
from evdash.domain.study import ALL_NODES, Axis, Case, Seeds, Study
from evdash.grid.reduction import limit_rows

MONEY = ("profit", "acceptance", "admitted", "peak_station_kw", "headroom_use")
GRID = ("least_headroom_kw", "mean_headroom_kw", "lowest_ac_pu", "ac_limits_broken")
DAYS, MANY_DAYS, FEW_DAYS = 20, 100, 8


@dataclass(frozen=True, slots=True)
class Question:
    """A question in a planner's words, what its answer shows, and the study that answers it."""

    title: str
    told: str
    study: Callable[[Scenario], Study]


def _study(
    scenario: Scenario,
    title: str,
    days: int,
    axes: tuple[Axis, ...],
    metrics: tuple[str, ...] = (*MONEY, *GRID),
) -> Study:
    drawn = isinstance(scenario.arrivals, GeneratedArrivals)
    return Study(
        format=1,
        name=title,
        question=f"{scenario.name}: {title}",
        base="scenario",
        seeds=Seeds(count=days) if drawn else None,
        metrics=metrics,
        axis=axes,
    )


def _around(count: int) -> tuple[int, ...]:
    """Counts from half to twice a count, seven at most."""
    return tuple(sorted({max(1, round(count * f)) for f in (0.5, 0.75, 1, 1.25, 1.5, 2)}))


def _whole(value: float) -> float:
    """A value to a decimal, as a whole number where it is one."""
    near = round(value, 1)
    return int(near) if near == int(near) else near


def chargers(scenario: Scenario) -> Study:
    """The station with fewer and more chargers."""
    axis = Axis(name="chargers", key="station.chargers", values=_around(scenario.station.chargers))
    return _study(scenario, "How many chargers?", DAYS, (axis,))


def transformer(scenario: Scenario) -> Study:
    """Chargers against the rating of the line or transformer that limits most."""
    counts = _around(_chargers(scenario))
    axes: tuple[Axis, ...] = (Axis(name="chargers", key="station.chargers", values=counts),)
    line = limiting_line(scenario)
    if line is not None:
        name, rating = line
        values = tuple(_whole(rating * f) for f in (1, 1.25, 1.5, 2))
        axes += (Axis(name=f"rating of {name}, kVA", key=f"line.{name}.rating_kva", values=values),)
    return _study(scenario, "What does a bigger transformer bring?", FEW_DAYS, axes)


def _chargers(scenario: Scenario) -> int:
    return max(2, scenario.station.chargers)


def site(scenario: Scenario) -> Study:
    """The station at every node."""
    axis = Axis(name="site", key="station.node", values=ALL_NODES)
    return _study(scenario, "Where to put the station?", FEW_DAYS, (axis,), (*GRID, *MONEY))


def sure(scenario: Scenario) -> Study:
    """The same day with many random arrivals."""
    return _study(scenario, "How sure is that profit?", MANY_DAYS, ())


def tariff(scenario: Scenario) -> Study:
    """The day under energy tariffs from flat to steep, at the same mean price."""
    axis = Axis(name="price spread, times today's", key="price.spread", values=(0, 0.5, 1, 2, 4))
    return _study(scenario, "Which tariff?", DAYS, (axis,), ("energy_cost", *MONEY, *GRID))


def penetration(scenario: Scenario) -> Study:
    """More and more vehicles at the same station."""
    known = scenario.arrivals
    mean = known.vehicles_per_day if isinstance(known, GeneratedArrivals) else 100.0
    values = tuple(_whole(mean * f) for f in (0.25, 0.5, 0.75, 1, 1.5, 2, 3))
    axis = Axis(name="vehicles per day", key="arrivals.vehicles_per_day", values=values)
    return _study(scenario, "How many vehicles can it take?", DAYS, (axis,))


def upgrade(scenario: Scenario) -> Study:
    """What each next investment is worth, in pairs of the same days."""
    more = {"station.chargers": scenario.station.chargers + 2}
    cases = [Case(name="as it is", set={}), Case(name="2 more chargers", set=more)]
    line = limiting_line(scenario)
    if line is not None:
        name, rating = line
        larger = {f"line.{name}.rating_kva": _whole(1.5 * rating)}
        cases.append(Case(name=f"{name} at {1.5 * rating:g} kVA", set=larger))
        cases.append(Case(name="both", set=more | larger))
    axis = Axis(name="upgrade", case=tuple(cases))
    return _study(scenario, "What is the next upgrade worth?", 40, (axis,))


def band(scenario: Scenario) -> Study:
    """What a wider or narrower voltage band does."""
    source = abs(scenario.feeder.source_voltage_pu - 1)
    values = tuple(b for b in (0.02, 0.03, 0.04, 0.05, 0.07, 0.1) if b >= source)
    axis = Axis(name="voltage band, ± pu", key="voltage.band_pu", values=values or (source + 0.01,))
    return _study(
        scenario, "What does a wider voltage band bring?", FEW_DAYS, (axis,), (*GRID, *MONEY)
    )


def limiting_line(scenario: Scenario) -> tuple[str, float] | None:
    """The rated line that is tightest for the station in most intervals, and its rating, kVA."""
    found = Counter(
        element
        for element in limit_rows(scenario).binding()
        if element is not None and element.kind == "line"
    )
    for element, _ in found.most_common(1):
        rating = scenario.rating_kva_of(element)
        if rating:
            return scenario.file_name(element).removeprefix("line:"), rating
    return None


QUESTIONS: Mapping[str, Question] = {
    "chargers": Question(
        "How many chargers?",
        "Profit, acceptance and load with half to twice as many chargers, each over the same days.",
        chargers,
    ),
    "transformer": Question(
        "What does a bigger transformer bring?",
        "Chargers against the rating of the line or transformer that limits the station most.",
        transformer,
    ),
    "site": Question(
        "Where to put the station?",
        "The station at every node but the source: the room the feeder has there at every hour, "
        "what it would earn, and a map.",
        site,
    ),
    "upgrade": Question(
        "What is the next upgrade worth?",
        "Each investment against the station as it is, in $ and vehicles a day, on the same days.",
        upgrade,
    ),
    "sure": Question(
        "How sure is that profit?",
        "The same day with a hundred draws of who arrives: what lies between 5 and 95 % of them.",
        sure,
    ),
    "tariff": Question(
        "Which tariff?",
        "Energy prices from flat to four times as spread, their mean unchanged. Drivers come as "
        "before: the model does not have them react to prices.",
        tariff,
    ),
    "penetration": Question(
        "How many vehicles can it take?",
        "A quarter to three times as many vehicles a day: where acceptance begins to fall.",
        penetration,
    ),
    "band": Question(
        "What does a wider voltage band bring?",
        "Voltage limits from narrow to wide, and what room they leave the station.",
        band,
    ),
}
