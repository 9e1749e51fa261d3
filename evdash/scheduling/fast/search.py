"""What is known so far in one solve: the best point, the proven bound, the effort left."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.effort import Effort
from evdash.scheduling.fast.relaxation import Relaxation
from evdash.scheduling.fast.rounding import relaxed_and_cut
from evdash.scheduling.highs import LpPoint, Session
from evdash.scheduling.problem import TIE_USD, Bools, Problem, Solution

RUNNING_KW = 1e-7
"""Power that counts as running: above what the LP's tolerance leaves over."""
POWER_TOLERANCE_KW = 1e-9
CUT_ROUNDS = 12
WHOLE_U = 1e-6


@dataclass(slots=True)
class Search:
    """One solve under way. `admitted`, `power_kw` and `cost` are the best point found."""

    relaxation: Relaxation
    session: Session
    effort: Effort
    admitted: Bools
    power_kw: Floats
    cost: float
    bound: float = -np.inf

    @property
    def problem(self) -> Problem:
        return self.relaxation.problem

    @property
    def target(self) -> float:
        """A point no dearer than this is proven optimal, $."""
        return self.bound + TIE_USD

    @property
    def proven(self) -> bool:
        return self.cost <= self.target

    def offer(self, values: Floats) -> None:
        """Take a point of P1 as the best if it is cheaper."""
        admitted = values[self.relaxation.columns.u] > 0.5
        power_kw = self.relaxation.power_kw(values)
        power_kw[power_kw <= RUNNING_KW] = 0.0
        cost = self.problem.objective(admitted, power_kw)
        if cost < self.cost:
            self.admitted, self.power_kw, self.cost = admitted, power_kw, cost

    def relaxed(self, lower: Floats, upper: Floats, cut_rounds: int = 0) -> LpPoint | None:
        """The LP over lower ≤ u ≤ upper, (vehicles,), cut off where its point violates cuts."""
        self.session.bound(self.relaxation.columns.u, lower, upper)
        return relaxed_and_cut(self.relaxation, self.session, self.effort, cut_rounds)

    def conflicts(self, values: Floats) -> tuple[Bools, Bools]:
        """What keeps a point with u whole from being one of P1.

        Pairs that run below their lowest power, (pairs,); slots with more vehicles running
        than chargers, (slots,).
        """
        at = self.relaxation.columns
        power = values[: at.n_pairs]
        running = power > RUNNING_KW
        low = self.relaxation.charges.low_kw[at.vehicle]
        count = np.bincount(at.slot[running], minlength=self.problem.n_slots)
        return running & (power < low - POWER_TOLERANCE_KW), count > self.problem.chargers

    def solution(self) -> Solution:
        return Solution(self.admitted, self.power_kw, self.bound)


def is_whole(u: Floats) -> bool:
    """Whether every request is admitted or refused, none by halves."""
    return bool((np.abs(u - np.round(u)) <= WHOLE_U).all())
