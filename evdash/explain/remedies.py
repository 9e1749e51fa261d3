"""The least change that would have admitted a refused vehicle, found and verified by solving."""

from bisect import bisect_left
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from math import ceil, log10
from typing import Literal

import numpy as np

from evdash.explain.causes import slots_beyond_headroom, unlimited
from evdash.explain.changes import NOTHING, Change
from evdash.explain.search import Ladder
from evdash.explain.trials import Trials
from evdash.scheduling.problem import OPTIMALITY_USD

RemedyKind = Literal["chargers", "headroom", "time", "price", "amount", "max_kw"]

HEADROOM_STEPS_KW = ((5.0, 0.1), (20.0, 0.5), (100.0, 2.0), (np.inf, 50.0))
"""Headroom is told in steps of 0.1 kW up to 5 kW, of 0.5 kW up to 20 kW, and so on."""
PREFERRED = (1.0, 1.25, 1.6, 2.0, 2.5, 3.2, 4.0, 5.0, 6.3, 8.0)
"""Where a crowd competes, in amounts graded as ratings are: ten a decade (R10 of ISO 3)."""
FIRST_STRIDE, FIRST_STRIDE_GRADED = 16, 4
"""The same for all vehicles, so that those who ask together share what is solved."""
PRICE_STEP_USD = 1e-4
HAIR_KW = 1e-6
MOST_HOURS_LATER = 12


@dataclass(frozen=True, slots=True)
class Remedy:
    """A change with which P1 admits the vehicle, and a little less with which it does not.

    `amount`: chargers (count), headroom (kW, in every interval of its time), time (intervals
    later), price ($/kWh more), amount (kWh more or, below zero, less), max_kw (kW more).
    `least`: whether it is proven, to P1's cent, that nothing less would do; otherwise it is
    the least found. `intervals`: those in which more headroom, or chargers, are really used;
    more headroom in them alone admits the vehicle too.
    """

    kind: RemedyKind
    amount: float
    refused_at: float
    least: bool
    intervals: tuple[int, ...] = ()

    @property
    def change(self) -> Change:
        """What `changed` takes to apply it."""
        return change_by(self.kind, self.amount)


@dataclass(frozen=True, slots=True)
class NoRemedy:
    """A kind of change that does not help up to `most` (as Remedy.amount; inf: however much).

    `proven` where no amount whatever can help; otherwise none was found.
    """

    kind: RemedyKind
    most: float
    proven: bool


def change_by(kind: RemedyKind, amount: float) -> Change:
    """The change of an amount of one thing."""
    if kind == "chargers":
        return Change(chargers=round(amount))
    if kind == "headroom":
        return Change(headroom_kw=amount)
    if kind == "time":
        return Change(later=round(amount))
    if kind == "price":
        return Change(price_per_kwh=amount)
    return Change(need_kwh=amount) if kind == "amount" else Change(max_kw=amount)


def remedies_of(trials: Trials) -> tuple[Remedy | NoRemedy, ...]:
    """For chargers, headroom, time and price in turn: the least that would have done, or none."""
    return (
        more_chargers(trials),
        more_headroom(trials),
        later_return(trials),
        higher_price(trials),
    )


def more_chargers(trials: Trials) -> Remedy | NoRemedy:
    """n chargers more."""
    everyone = unlimited(trials, chargers=True)
    if everyone == NOTHING or cannot_help(trials, everyone):
        return NoRemedy("chargers", np.inf, proven=True)
    found = Ladder(trials, lambda n: change_by("chargers", n)).climb(1, everyone.chargers)
    if found.steps is None:
        return NoRemedy("chargers", np.inf, proven=found.least)
    charging = trials.plan(change_by("chargers", found.steps)).charging
    return Remedy(
        kind="chargers",
        amount=found.steps,
        refused_at=found.steps - 1,
        least=found.least,
        intervals=_intervals(trials, np.flatnonzero(charging > trials.snapshot.chargers)),
    )


def more_headroom(trials: Trials) -> Remedy | NoRemedy:
    """x kW more headroom, in every interval of the vehicle's time."""
    everything = unlimited(trials, headroom=True)
    room = trials.snapshot.rows.headroom_kw()[: trials.window]
    if not np.isfinite(room).any() or cannot_help(trials, everything):
        return NoRemedy("headroom", np.inf, proven=True)
    graded, stride = (
        (graded_headroom_kw, FIRST_STRIDE_GRADED)
        if trials.is_crowded
        else (headroom_grid_kw, FIRST_STRIDE)
    )
    grid_kw = graded(trials.all_power_kw)
    unfit = bisect_left(grid_kw, trials.least_headroom_kw() - HAIR_KW) - 1
    ladder = Ladder(
        trials, lambda steps: change_by("headroom", grid_kw[steps]), unfit=max(0, unfit)
    )
    found = ladder.climb(stride, len(grid_kw) - 1)
    if found.steps is None:
        return NoRemedy("headroom", np.inf, proven=found.least)
    amount = grid_kw[found.steps]
    return Remedy(
        kind="headroom",
        amount=amount,
        refused_at=grid_kw[found.steps - 1],
        least=found.least,
        intervals=_intervals(trials, _slots_used(trials, change_by("headroom", amount))),
    )


def headroom_grid_kw(most_kw: float) -> list[float]:
    """Amounts of headroom tried, kW, from 0 to beyond `most_kw`: the larger, the coarser."""
    grid = [0.0]
    while grid[-1] < most_kw:
        below = (step for end, step in HEADROOM_STEPS_KW if grid[-1] < end)
        grid.append(round(grid[-1] + next(below), 6))
    return grid


def graded_headroom_kw(most_kw: float) -> list[float]:
    """The same from 0.1 kW in preferred numbers."""
    decades = range(-1, max(0, ceil(log10(max(1.0, most_kw)))) + 1)
    grid = [round(number * 10.0**power, 6) for power in decades for number in PREFERRED]
    return [0.0, *grid[: bisect_left(grid, most_kw) + 1]]


def _intervals(trials: Trials, slots: Iterable[int]) -> tuple[int, ...]:
    return tuple(trials.snapshot.now + int(slot) for slot in slots)


def _slots_used(trials: Trials, change: Change) -> tuple[int, ...]:
    """Slots in which more headroom is really used, dropping at both ends what is not needed.

    The plan may draw on it early only because it costs nothing; what can go without the
    vehicle being refused, goes.
    """
    used = slots_beyond_headroom(trials, trials.plan(change).station_kw)
    if not used or not trials.admits(replace(change, slots=used)):
        return tuple(range(trials.window))

    def admits(first: int, end: int) -> bool:
        return trials.admits(replace(change, slots=used[first:end]))

    end = len(used)
    first = _most_dropped(lambda n: admits(n, end), end - 1)
    end -= _most_dropped(lambda n: admits(first, end - n), end - 1 - first)
    return used[first:end]


def _most_dropped(still_admits: Callable[[int], bool], most: int) -> int:
    """How many slots can go, found by halving."""
    kept, dropped = most + 1, 0
    while kept - dropped > 1:
        middle = (kept + dropped) // 2
        if still_admits(middle):
            dropped = middle
        else:
            kept = middle
    return dropped


def later_return(trials: Trials) -> Remedy | NoRemedy:
    """A return y intervals later.

    P1 without the vehicle stays as it is and P1 with it only gains: there is one threshold.
    """
    hours = trials.snapshot.interval_hours
    most = round(MOST_HOURS_LATER / hours)
    if trials.lp_bound_with(Change(later=most)) >= trials.cost_without:
        return NoRemedy("time", most, proven=True)
    ladder = Ladder(trials, lambda n: change_by("time", n), single=True)
    found = ladder.climb(max(1, round(1 / hours)), most)
    if found.steps is None:
        return NoRemedy("time", most, proven=found.least)
    return Remedy("time", amount=found.steps, refused_at=found.steps - 1, least=True)


def higher_price(trials: Trials) -> Remedy | NoRemedy:
    """z $/kWh more, from what P1 costs with the vehicle and what it costs without.

    P1 is optimal to a cent and no closer. The price told is one at which admitting is certain,
    `refused_at` one at which refusing is; what lies between is left to chance.
    """
    request = trials.request
    if not np.isfinite(trials.cost_with()):
        return NoRemedy("price", np.inf, proven=trials.cannot_fit())
    certain = trials.cost_with() - trials.bound_without + OPTIMALITY_USD
    hopeless = trials.bound_with() - trials.cost_without - OPTIMALITY_USD
    steps = np.ceil(certain / request.need_kwh / PRICE_STEP_USD)
    less = np.floor(hopeless / request.need_kwh / PRICE_STEP_USD)
    more, less = (round(max(n, 0) * PRICE_STEP_USD, 6) for n in (max(1, steps), less))
    return Remedy("price", amount=more, refused_at=less, least=True)


def cannot_help(trials: Trials, change: Change) -> bool:
    """Whether it is certain that neither a change nor any smaller one admits the vehicle.

    Less of it cannot make P1 with the vehicle cheaper, nor P1 without it dearer than it was.
    """
    if trials.lp_bound_with(change) >= trials.cost_without:
        return True
    return not trials.admits(change) and trials.bound_with(change) >= trials.cost_without
