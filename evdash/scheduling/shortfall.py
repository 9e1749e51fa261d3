"""What contracts would miss at the least, if limits are lowered under them."""

import numpy as np
import pulp

from evdash.domain.limits import Floats
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import ENERGY_TOLERANCE_KWH
from evdash.errors import ImpossibleCommitments, Shortfall, SolverFailure
from evdash.scheduling.clean import cleaned
from evdash.scheduling.equations import LEAST_SHORTFALL, build
from evdash.scheduling.problem import contracts_problem
from evdash.scheduling.reference import minimise_with_highs, power_of, values

SECONDS = 20.0


def plan_for_contracts(snapshot: Snapshot) -> Floats:
    """A schedule (contracts, slots) in kW that keeps every contract, whatever it costs.

    Raises ImpossibleCommitments with the least possible missing energy if there is none,
    SolverFailure if that could not be found out in time.
    """
    problem = contracts_problem(snapshot)
    if problem.n_vehicles == 0:
        return problem.tail_kw
    model = build(problem, LEAST_SHORTFALL, "least_shortfall")
    minimise_with_highs(model, SECONDS, absolute_gap=0.0)
    if model.lp.sol_status != pulp.LpSolutionOptimal:
        raise SolverFailure("whether the contracts can be kept could not be decided in time")
    short = values(model.short_kwh)
    missing = np.flatnonzero(short > 10 * ENERGY_TOLERANCE_KWH)
    if len(missing):
        raise ImpossibleCommitments(
            [Shortfall(problem.vehicles[n], float(short[n])) for n in missing]
        )
    return cleaned(problem, np.ones(problem.n_vehicles, dtype=bool), power_of(model))
