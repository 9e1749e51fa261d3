"""P1's optimum at each interval as proven anew, held against what a run's files say of it.

What is to be solved is put together here, from files and the grid alone; who solves it, the
plain formulation, is for the caller.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from evdash.audit.moments import Moment, Owed, moments
from evdash.audit.record import RunRecord
from evdash.domain.limits import LimitRows
from evdash.domain.plan import Snapshot
from evdash.domain.scenario import Scenario
from evdash.domain.tariff import Tariff
from evdash.domain.trace import Network
from evdash.domain.vehicles import Contract, Request
from evdash.files.run_tables import IntervalRow
from evdash.grid.reduction import limit_rows

CENT = 0.01
HAIR_USD = 1e-3
"""What the hair by which limits are widened is worth at most, and solvers' own tolerances."""
HAIR_KW = 1e-6
"""Headroom is widened by this, so that no rounding makes a plan there was impossible."""


@dataclass(frozen=True, slots=True)
class Question:
    """P1 at one interval, as it stood then; None where the files do not say enough.

    `untold` names the contracts of which they do not say what was owed.
    """

    row: IntervalRow
    snapshot: Snapshot | None
    untold: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Optimum:
    """The value of a point of P1 and a bound on all of them, $, as found anew."""

    value: float
    bound: float

    @property
    def is_proven(self) -> bool:
        """Whether they are within a cent."""
        return self.value <= self.bound + CENT + HAIR_USD


def questions(run: RunRecord) -> Iterator[Question]:
    """Every interval's P1, in order; what was expected of feeder and prices as known then."""
    known: Scenario | None = None
    rows: LimitRows | None = None
    for moment, row in zip(moments(run), run.intervals, strict=True):
        if moment.known is not known or rows is None:
            known, rows = moment.known, _rows(moment.known, run.network)
        if moment.untold:
            yield Question(row, None, moment.untold)
        else:
            yield Question(row, _snapshot(moment, rows), ())


def _rows(known: Scenario, network: Network) -> LimitRows:
    if network == "ac":
        # power flows in batch are slow to import, and linearised runs need none
        from evdash.grid.aclimits import ac_limit_rows  # noqa: PLC0415

        rows = ac_limit_rows(known)
    else:
        rows = limit_rows(known)
    return replace(rows, limit_kw=np.maximum(0.0, rows.limit_kw) + HAIR_KW)


def _snapshot(moment: Moment, rows: LimitRows) -> Snapshot:
    k, known = moment.interval, moment.known
    contracts = tuple(Contract(_request(one, known)) for one in moment.contracts)
    return Snapshot(
        now=k,
        chargers=known.station.chargers,
        tariff=Tariff(known.price_per_kwh[k:], known.interval_hours),
        rows=rows.from_interval(k),
        contracts=contracts,
        requests=tuple(_request(one, known) for one in moment.newcomers),
        tail_kw=np.zeros((len(contracts), known.intervals - k)),
    )


def _request(owed: Owed, known: Scenario) -> Request:
    """What is owed as a request for it."""
    return Request(
        vehicle=owed.vehicle,
        option="",
        arrival=known.start,
        arrival_interval=owed.first,
        deadline_interval=owed.deadline,
        need_kwh=owed.owed_kwh,
        price_per_kwh=owed.revenue / owed.owed_kwh,
        min_kw=owed.min_kw,
        max_kw=owed.max_kw,
        battery_kwh=owed.owed_kwh,
        soc_in=0.0,
        soc_out=1.0,
    )


def optimum_findings(row: IntervalRow, optimum: Optimum) -> Iterator[str]:
    """What an interval's objective, bound and status say that P1 solved anew does not bear out."""
    at = f"interval {row.interval}"
    if row.objective is None:
        return  # told by the audit of objectives
    if row.objective < optimum.bound - HAIR_USD:
        yield f"{at}: objective is {row.objective:.4f} $, no plan costs under {optimum.bound:.4f} $"
    if row.bound is not None and row.bound > optimum.value + HAIR_USD:
        yield f"{at}: bound is {row.bound:.4f} $, yet a plan costs {optimum.value:.4f} $"
    if row.status == "optimal" and row.objective > optimum.value + CENT + HAIR_USD:
        yield (
            f"{at}: optimal at {row.objective:.4f} $, yet a plan costs {optimum.value:.4f} $: "
            "more than a cent less"
        )
