"""The contracts chosen, when does who charge? Recourse: u fixed, most of D settled by the LP."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.branch import Settled, branch
from evdash.scheduling.fast.search import CUT_ROUNDS, RUNNING_KW, Search
from evdash.scheduling.highs import LpPoint
from evdash.scheduling.rows import Indices

NODES = 500
DIVES = 12


def schedule_for(search: Search, u: Floats) -> None:
    """Offer the cheapest schedule found for contracts `u` (vehicles,), until one is proven.

    First the LP, then its conflicts rounded away, then branch and bound over the pairs the LP
    uses; wider neighbourhoods took longer than the full problem.
    """
    search.session.bound(search.relaxation.columns.u, u, u)
    lp = search.relaxed(CUT_ROUNDS)
    if lp is None:
        return
    rounded(search, lp, search.target)
    if not search.proven and not search.out_of_time and lp.objective <= search.target:
        around(search, u, lp)


def around(search: Search, u: Floats, lp: LpPoint) -> None:
    """Branch and bound near the LP's point: off where it is off, on where it is at the top."""
    at = search.relaxation.columns
    power = lp.values[: at.n_pairs]
    off = power <= RUNNING_KW
    on = power >= search.relaxation.charges.top_kw[at.vehicle] - RUNNING_KW
    outcome = branch(search, Settled(off, on & ~off, u, u), nodes=NODES, target=search.target)
    if outcome.values is not None:
        search.offer(outcome.values)


@dataclass(frozen=True, slots=True)
class Rounding:
    """Bounds on P while diving, (pairs,), kW: 0 above where switched off, low below where on."""

    lower: Floats
    upper: Floats

    def switched(self, on: Indices, off: Indices, low_kw: Floats) -> "Rounding":
        """These pairs switched on and off besides."""
        lower, upper = self.lower.copy(), self.upper.copy()
        lower[on] = low_kw[on]
        upper[off] = 0.0
        return Rounding(lower, upper)


def rounded(search: Search, lp: LpPoint, ceiling: float) -> None:
    """Dive: switch conflicting pairs on or off, solve the LP again, until no conflict is left.

    All conflicts at once; where that costs more than `ceiling`, the first alone, on or off.
    """
    at = search.relaxation.columns
    low = search.relaxation.charges.low_kw[at.vehicle]
    top = search.relaxation.charges.top_kw[at.vehicle]
    bounds = Rounding(np.zeros(at.n_pairs), top)
    values: Floats | None = lp.values
    for _ in range(DIVES):
        if values is None:
            break
        on, off = switches(search, values, bounds)
        if len(on) + len(off) == 0:
            if not any(conflict.any() for conflict in search.conflicts(values)):
                search.offer(values)
            break
        first = np.concatenate([on, off])[:1]
        nobody = first[:0]
        tried = [(on, off), (first, nobody), (nobody, first)]
        values = None
        for switched_on, switched_off in tried[0 if len(on) + len(off) > 1 else 1 :]:
            attempt = bounds.switched(switched_on, switched_off, low)
            search.session.bound(np.arange(at.n_pairs), attempt.lower, attempt.upper)
            point = search.relaxed()
            if point is not None and point.objective <= ceiling:
                bounds, values = attempt, point.values
                break
    search.session.bound(np.arange(at.n_pairs), np.zeros(at.n_pairs), top)


def switches(search: Search, values: Floats, bounds: Rounding) -> tuple[Indices, Indices]:
    """Which pairs to switch on and off at a point: (on, off).

    In slots with too many running the weakest go; elsewhere what runs below its lowest power
    goes to the nearer of off and on, the surest first.
    """
    at, problem = search.relaxation.columns, search.problem
    power = values[: at.n_pairs]
    low = search.relaxation.charges.low_kw[at.vehicle]
    short, crowded = search.conflicts(values)
    off: list[Indices] = []
    for slot in np.flatnonzero(crowded):
        running = np.flatnonzero((at.slot == slot) & (power > RUNNING_KW))
        free = running[bounds.lower[running] == 0]
        off.append(free[np.argsort(power[free], kind="stable")][: len(running) - problem.chargers])
    weak = np.flatnonzero(short & ~crowded[at.slot])
    share = power[weak] / low[weak]
    on = weak[share >= 0.5][np.argsort(-share[share >= 0.5], kind="stable")]
    if not crowded.any():
        off.append(weak[share < 0.5])
    return on, np.concatenate([np.empty(0, dtype=np.intp), *off])
