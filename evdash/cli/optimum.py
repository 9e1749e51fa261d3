"""`audit --optimum`: P1 proven anew at every interval by the plain formulation."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from evdash.audit.proof import Optimum, optimum_findings, questions
from evdash.audit.record import RunRecord
from evdash.cli.terminal import progress_bar
from evdash.domain.plan import Snapshot
from evdash.domain.vehicles import Contract
from evdash.errors import SolverFailure
from evdash.scheduling.effort import Effort
from evdash.scheduling.p1 import WORK
from evdash.scheduling.problem import Problem, contracts_problem
from evdash.scheduling.reference import solve_reference

HAIR_KW = 1e-6
"""Chargers' ranges are widened by this, so that no rounding makes a plan there was impossible."""


@dataclass(frozen=True, slots=True)
class Proofs:
    """`findings` are what is wrong; `proven` counts intervals proven to the cent, `open` names
    those that were not, and why."""

    proven: int
    findings: tuple[str, ...]
    open: tuple[str, ...]


def prove(run: RunRecord) -> Proofs:
    """Solve P1 of every interval of a run again, with progress on standard error."""
    findings: list[str] = []
    unproven: list[str] = []
    proven = 0
    with progress_bar() as progress:
        task = progress.add_task("proving", total=len(run.intervals))
        for question in questions(run):
            at = f"interval {question.row.interval}"
            if question.snapshot is None:
                names = ", ".join(question.untold)
                unproven.append(f"{at}: the files do not tell what was owed to {names}")
            else:
                optimum = optimum_of(question.snapshot)
                findings += optimum_findings(question.row, optimum)
                proven += optimum.is_proven
                unproven += _unproven(at, optimum)
            progress.advance(task)
    return Proofs(proven, tuple(findings), tuple(unproven))


def _unproven(at: str, optimum: Optimum) -> Iterator[str]:
    if not np.isfinite(optimum.value):
        yield f"{at}: the plain formulation found no plan"
    elif not optimum.is_proven:
        gap = optimum.value - optimum.bound
        yield f"{at}: the plain formulation came to within {gap:.4f} $, and no nearer"


def optimum_of(snapshot: Snapshot) -> Optimum:
    """P1 of a snapshot solved as the paper writes it; without a plan found, no value at all."""
    problem = _problem(snapshot)
    if not problem.n_vehicles:
        return Optimum(0.0, 0.0)
    try:
        solution = solve_reference(problem, Effort(WORK))
    except SolverFailure:
        return Optimum(np.inf, -np.inf)
    return Optimum(problem.objective(solution.admitted, solution.power_kw), solution.bound)


def _problem(snapshot: Snapshot) -> Problem:
    """P1 with nothing taken from a last plan, which no file holds."""
    n_contracts = len(snapshot.contracts)
    newcomers = tuple(Contract(request) for request in snapshot.requests)
    everyone = replace(
        snapshot,
        contracts=(*snapshot.contracts, *newcomers),
        tail_kw=np.zeros((n_contracts + len(newcomers), snapshot.n_slots)),
    )
    problem = contracts_problem(everyone, n_firm=n_contracts)
    new = np.arange(problem.n_vehicles) >= n_contracts
    return replace(
        problem,
        revenue=np.where(new, problem.revenue, 0.0),
        low_kw=np.maximum(0.0, problem.low_kw - HAIR_KW),
        high_kw=problem.high_kw + HAIR_KW,
    )
