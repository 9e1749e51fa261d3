"""The whole horizon at a glance: what was executed up to now and what is planned from now on."""

from dataclasses import dataclass
from datetime import datetime

from evdash.domain.elements import Element
from evdash.domain.limits import Floats


@dataclass(frozen=True, slots=True)
class Outlook:
    """Conditions of every interval under the inputs in force when it was, or will be, decided.

    Interval t runs from `times[t]` to `times[t + 1]`; those before `now` are executed, the
    others planned. Shapes: times (intervals + 1,); voltage_pu and base_voltage_pu, the latter
    without the station, (intervals, nodes), linearised; all others (intervals,). `headroom_kw`
    is inf and `binding` None where nothing limits. `station_rating_kw` is what the station's load
    is measured against: the rating nearest to it on its way to the source, or the most its
    chargers can draw.
    """

    now: int
    times: tuple[datetime, ...]
    price_per_kwh: Floats
    load_kw: Floats
    station_kw: Floats
    headroom_kw: Floats
    binding: tuple[Element | None, ...]
    nodes: tuple[str, ...]
    voltage_pu: Floats
    base_voltage_pu: Floats
    voltage_min_pu: float
    voltage_max_pu: float
    station_rating_kw: float

    @property
    def n_intervals(self) -> int:
        return len(self.times) - 1

    @property
    def start(self) -> datetime:
        return self.times[0]

    @property
    def end(self) -> datetime:
        return self.times[-1]

    @property
    def clock(self) -> datetime:
        """The time it is: the start of the interval to be decided next."""
        return self.times[self.now]

    @property
    def crosses_midnight(self) -> bool:
        """Whether clock times alone would be ambiguous."""
        return (self.end - self.start).total_seconds() > 24 * 3600
