"""Words that all sentences share: limits by name, how far one is exceeded, counts."""

from collections.abc import Callable

from evdash.domain.elements import CHARGERS, Element
from evdash.domain.scenario import Scenario


def element_words(
    element: Element | None, scenario: Scenario, name: Callable[[str], str] = str
) -> str:
    """A limit as a person names it: `line or transformer 633–634 (500 kVA)`.

    `name` sets what users have called things, as where they are escaped.
    """
    if element is None:
        return "nothing"
    node, feeder = f"node {name(element.node)}", scenario.feeder
    if element.is_rating:
        ends = f"line or transformer {name(element.node)}–{name(element.to_node)}"
        of = ends if element.kind == "line" else f"the rating of {node}"
        back = " against power flowing back" if element.is_export else ""
        return f"{of} ({scenario.rating_kva_of(element) or 0:g} kVA){back}"
    return {
        "voltage_min": f"the lowest voltage allowed at {node} ({feeder.voltage_min_pu:g} pu)",
        "voltage_max": f"the highest voltage allowed at {node} ({feeder.voltage_max_pu:g} pu)",
        "power_flow": f"voltage collapse at {node}, where more power has no AC solution",
        "chargers": f"the number of chargers ({scenario.station.chargers})",
    }[element.kind]


def element_name(element: Element | None) -> str:
    """A limit in a few words: for labels and cells of a table."""
    if element is None:
        return "nothing"
    if element == CHARGERS:
        return str(element)
    words = {"node": "rating of node", "line": "rating of", "power_flow": "voltage collapse at"}
    back = ", power flowing back" if element.is_export else ""
    return f"{words.get(element.kind, 'voltage at')} {element.name}{back}"


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
