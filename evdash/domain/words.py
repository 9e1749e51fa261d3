"""Words that all sentences share: limits by name, how far one is exceeded, counts."""

from collections.abc import Callable

from evdash.domain.scenario import Scenario

CHARGERS = "chargers"
"""The one limit that is no element of the feeder."""


def element_words(
    element: str,
    scenario: Scenario,
    name: Callable[[str], str] = str,
    *,
    is_export: bool = False,
) -> str:
    """A limit as a person names it: `line or transformer 633–634 (500 kVA)`.

    `name` sets what users have called things, as where they are escaped; `is_export` where it is
    power flowing back that is limited.
    """
    kind, _, found = element.partition(":")
    called = name(found)
    low_pu, high_pu = scenario.feeder.voltage_min_pu, scenario.feeder.voltage_max_pu
    words = {
        "voltage_min": f"the lowest voltage allowed at node {called} ({low_pu:g} pu)",
        "voltage_max": f"the highest voltage allowed at node {called} ({high_pu:g} pu)",
        "power_flow": f"voltage collapse at node {called}, where more power has no AC solution",
        CHARGERS: f"the number of chargers ({scenario.station.chargers})",
    }
    if kind in words:
        return words[kind]
    back = " against power flowing back" if is_export else ""
    if kind == "node":
        rating = next((n.rating_kva for n in scenario.nodes if n.node == found), None)
        return f"the rating of node {called} ({rating or 0:g} kVA){back}"
    line = next((line for line in scenario.lines if line.name == found), None)
    if line is None:
        return name(element)
    ends = f"{name(line.from_node)}–{name(line.to_node)}"
    return f"line or transformer {ends} ({line.rating_kva or 0:g} kVA){back}"


def element_name(element: str, *, is_export: bool = False) -> str:
    """A limit in a few words: for labels and cells of a table."""
    if element == CHARGERS:
        return CHARGERS
    kind, _, name = element.partition(":")
    words = {
        "voltage_min": "voltage at",
        "voltage_max": "voltage at",
        "node": "rating of node",
        "power_flow": "voltage collapse at",
    }
    back = ", power flowing back" if is_export else ""
    return f"{words.get(kind, 'rating of')} {name}{back}" if element else "nothing"


def depth_words(depth: float, unit: str) -> str:
    """How far a limit is exceeded, with as many digits as its unit deserves, and never as none."""
    digits = {"pu": 4, "vehicles": 0}.get(unit, 1)
    least = 10.0**-digits
    if 0 < depth < least / 2:
        return f"less than {least:g} {unit}"
    return f"{depth:,.{digits}f} {unit if unit != 'vehicles' or round(depth) != 1 else 'vehicle'}"


def counted(number: int, one: str, many: str | None = None) -> str:
    """A number with its noun, `1 limit`, `1,203 limits`."""
    return f"{number:,} {one if number == 1 else many or one + 's'}"


def money(usd: float) -> str:
    """An amount to the cent, `$1,234.50`, `−$0.35`; without a sign where it rounds to none."""
    return f"{'−' if round(usd, 2) < 0 else ''}${abs(usd):,.2f}"


def some_money(usd: float) -> str:
    """An amount that is not told as none unless it is: `$1.20`, `less than a cent`."""
    return "less than a cent" if 0 < abs(usd) < 0.005 else money(usd)
