"""What a charger is told so that it draws a plan's energy: limits it can hold, in whole steps.

A plan gives mean powers of intervals, and one below the least power a charger can hold stands for
that power during a part of the interval (decision 3 of the model). OCPP counts limits in tenths of
a watt or an ampere and times in whole seconds; all rounding here is downward.
"""

import math
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Literal

from evdash.domain.vehicles import Request
from evdash.errors import Fault, InputError

Unit = Literal["W", "A"]
WATT_PER_KW = 1000.0
STEPS_PER_UNIT = 10
"""OCPP 1.6 knows limits in tenths."""
SAME_W = 1e-3
"""Powers are a plan's to 1e-6 kWh, so that 3,299.9999 W are the 3,300 W meant."""
LEAST_VOLTS, MOST_VOLTS = 50.0, 1000.0

Part = tuple[int, int, float]
"""Begin and length in s, and the limit held for so long; 0 in all the rest."""


@dataclass(frozen=True, slots=True)
class Current:
    """What an outlet is connected to: `phases` lines at `volts`, each to the return it uses."""

    phases: int
    volts: float

    @property
    def text(self) -> str:
        return f"{self.phases} x {self.volts:g} V"


def current_of(text: str) -> Current:
    """`3x230` as phases and volts; InputError for anything else."""
    found = re.fullmatch(r"([123])x(\d{1,4}(?:\.\d{1,3})?)", text.strip())
    if found and LEAST_VOLTS <= float(found[2]) <= MOST_VOLTS:
        return Current(int(found[1]), float(found[2]))
    allowed = (
        f"should be phases and the voltage of each, 1 to 3 and {LEAST_VOLTS:g} to {MOST_VOLTS:g} "
        "V: 3x230, 1x240"
    )
    raise InputError([Fault("the outlets' supply", repr(text), allowed)])


@dataclass(frozen=True, slots=True)
class Steps:
    """The limits one vehicle's charger can hold, counted in steps of `step_w`."""

    step_w: float
    least: int
    most: int
    draws_w: float

    def flat(self, power_w: float) -> int:
        """The highest step not above a power."""
        return math.floor((power_w + SAME_W) / self.step_w)

    def held(self, power_w: float, seconds: int) -> tuple[int, int]:
        """A step and how many s it is held so that the mean of an interval is `power_w`.

        All of the interval where the charger can hold the power, else as few s as its least
        power needs; short of the plan by less than a step, or than a second of `draws_w`.
        """
        flat = self.flat(power_w)
        if flat >= self.least:
            return flat, seconds
        energy_ws = power_w * seconds
        held = math.floor((energy_ws + SAME_W) / self.draws_w)
        if held <= 0:
            return 0, seconds
        return max(self.least, min(self.most, self.flat(energy_ws / held))), held


def steps_of(request: Request, current: Current | None) -> Steps:
    """The steps between the least and the most a charger may give a vehicle, W or A.

    A vehicle that takes less than the charger's least power is given that as its limit, for as
    long as it needs at its own. Raises InputError where no step is allowed.
    """
    step_w = (current.phases * current.volts if current else 1.0) / STEPS_PER_UNIT
    least_w, most_w = WATT_PER_KW * request.min_kw, WATT_PER_KW * request.max_kw
    least = math.ceil((least_w - SAME_W) / step_w)
    most = math.floor((most_w + SAME_W) / step_w)
    if most_w < least_w:
        return Steps(step_w, least, least, most_w)
    if most < max(least, 1):
        unit = f"A at {current.text}" if current else "W"
        found = f"{least_w:,.10g} to {most_w:,.10g} W, between two tenths of {unit}"
        allowed = "limits in OCPP are tenths: choose other ones (W instead of A, another voltage)"
        raise InputError([Fault(f"{request.vehicle}, what its charger can hold", found, allowed)])
    return Steps(step_w, least, most, max(least * step_w, step_w))


class Pulses:
    """Parts of intervals given out one after another, so that few of them meet."""

    def __init__(self, seconds: int) -> None:
        self.seconds = seconds
        self.taken_until: dict[int, int] = {}

    def begin(self, interval: int, held: int) -> int:
        """Where in an interval the next part of `held` s begins, s after its start."""
        begin = self.taken_until.get(interval, 0)
        if begin + held > self.seconds:
            begin = 0
        self.taken_until[interval] = begin + held
        return begin


def parts(
    window: range, power_w: Sequence[float], steps: Steps, pulses: Pulses
) -> tuple[Part, ...]:
    """What is held when over a window of intervals, s from its begin; in order of time."""
    seconds = pulses.seconds
    found = []
    for place, (interval, watt) in enumerate(zip(window, power_w, strict=True)):
        step, held = steps.held(watt, seconds)
        if step:
            begin = pulses.begin(interval, held) if held < seconds else 0
            found.append((place * seconds + begin, held, step / STEPS_PER_UNIT))
    return tuple(found)


def periods(found: Iterable[Part], duration: int) -> tuple[tuple[int, ...], tuple[float, ...]]:
    """Starts in s and limits as OCPP lists them: from 0 on, one only where the limit changes."""
    steps = [(0, 0.0)]
    for begin, held, limit in found:
        steps += [(begin, limit), (begin + held, 0.0)]
    last_at = {start: limit for start, limit in steps if start < duration}
    kept: list[tuple[int, float]] = []
    for start, limit in sorted(last_at.items()):
        if not kept or limit != kept[-1][1]:
            kept.append((start, limit))
    return tuple(start for start, _ in kept), tuple(limit for _, limit in kept)
