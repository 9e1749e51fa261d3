"""Energy prices of bundled days, as another day takes them on."""

from evdash.domain.trace import Trace
from evdash.ui.session import bundled, bundled_names
from evdash.ui.settings import curve_for, prices_from_now

CURVES = {"Ordinary": "summer-weekday", "Spike": "price-spike", "Negative": "negative-price"}


def curve_prices(trace: Trace, curve: str) -> tuple[float, ...]:
    """$/kWh of every interval with the prices of a curve from now on; the past as it was."""
    source = bundled(bundled_names()[CURVES[curve]])
    return prices_from_now(trace, curve_for(trace.scenario, source))


def curve_title(curve: str) -> str:
    """What taking on a curve is called."""
    return f"{curve.lower()} prices"
