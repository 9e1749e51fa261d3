"""Where chargers can bind at all: elsewhere their rows and the binaries behind them go."""

import numpy as np

from evdash.domain.limits import Floats
from evdash.scheduling.fast.charges import Charges
from evdash.scheduling.problem import Bools, Problem


def charger_slots(problem: Problem, charges: Charges, headroom_kw: Floats) -> Bools:
    """Slots in which more vehicles could run than chargers exist, shape (slots,).

    A slot has as many open windows as there are vehicles with L_n > t, less who is late. And
    however many are open: one more than chargers, each at its lowest power, must fit under the
    headroom.
    """
    open_windows = problem.window & charges.servable[:, None]
    crowd = problem.chargers + 1
    if len(charges.slots) < crowd:
        return np.zeros(problem.n_slots, dtype=bool)
    lowest = np.sort(np.where(open_windows, charges.low_kw[:, None], np.inf), axis=0)[:crowd]
    return np.asarray(lowest.sum(axis=0) <= headroom_kw * (1 + 1e-9) + 1e-9)
