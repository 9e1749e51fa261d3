"""The audit of refusals: who had to be refused, and why, as far as the files tell.

The closed forms are worked out again: what the door refuses, energy that costs more than it pays,
a feeder that cannot carry a vehicle alone. The others compare plans that are in no file.
"""

import math
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress

import numpy as np

from evdash.audit.asked import Asked
from evdash.audit.moments import Moment, Owed
from evdash.audit.objective import SOLVES_P1
from evdash.audit.record import RunRecord, kind_of
from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.plan import is_outside
from evdash.domain.refusal import CLAUSES, RefusalKind, RefusalReason
from evdash.domain.scenario import Scenario
from evdash.files.run_tables import VehicleRow

DOORS: frozenset[str] = frozenset(
    ("after the end", "no chargers", "unattainable", "end of horizon")
)
ALWAYS: frozenset[str] = DOORS | {"promises short", "fallback"}
RULES: frozenset[str] = frozenset(("feeder", "rule"))
FROM_OUTSIDE: frozenset[str] = frozenset(("feeder", "policy"))
NEVER_P1S = {"rule", "best day", "kept for others", "policy", "as told"}
BY_P1: frozenset[str] = frozenset(CLAUSES) - NEVER_P1S
KINDS: dict[str, frozenset[str]] = {
    "bid-price": BY_P1 | {"kept for others"},
    "oracle": frozenset(("best day",)),
    **dict.fromkeys(("fcfs", "edf", "llf", "uncoordinated"), RULES),
    **{name: BY_P1 for name, solves in SOLVES_P1.items() if solves},
}
"""The kinds of reason each policy gives, beside those that any policy gives."""
SEEKS_PROFIT = ("p1", "p1-plain", "bid-price")
ROUNDING = 1e-9
ROUNDING_KW = 1e-6
NEAR_USD = 1e-6
"""So near to what it pays, floating point decides whether energy costs less."""


def reason_findings(run: RunRecord, day: tuple[Moment, ...]) -> Iterator[str]:
    """What is wrong with who was refused, and why, as far as that can be worked out."""
    policy = str(run.summary.get("policy"))
    for row in run.vehicles:
        asked, kind = run.asked.get(row.vehicle), kind_of(row.reason)
        if asked is None:
            continue  # told by the audit of contracts
        if (row.status == "refused") != bool(row.reason):
            yield f"{row.vehicle}: {row.status}, reason is {row.reason!r}"
        elif row.reason and kind not in _kinds(policy) | ALWAYS:
            yield f"{row.vehicle}: {row.reason!r} is no reason that the policy {policy} gives"
        elif (kind if kind in DOORS else "") != asked.door:
            yield f"{row.vehicle}: reason is {row.reason!r}, worked out again {asked.door!r}"
        elif asked.door and row.reason != str(_door_reason(run, asked)):
            yield f"{row.vehicle}: reason is {row.reason!r}, not {_door_reason(run, asked)}"
        elif kind == "promises short" and not _may_be_short(run, asked):
            yield f"{row.vehicle}: reason is {row.reason!r}, yet no promise was short"
    rows = {row.vehicle: row for row in run.vehicles}
    decided = {row.interval: row.status for row in run.intervals}
    for moment in day:
        for one in moment.newcomers:
            if one.vehicle not in moment.admitted:
                fallback = decided.get(moment.interval) == "fallback"
                yield from _refused(run, moment, one, rows[one.vehicle], fallback=fallback)


def _kinds(policy: str) -> frozenset[str]:
    """The kinds of reason a policy gives; any for one there is not."""
    return KINDS.get(policy, FROM_OUTSIDE if is_outside(policy) else frozenset(CLAUSES))


def _door_reason(run: RunRecord, asked: Asked) -> RefusalReason:
    """What the door says, with its figures, of a vehicle it refuses."""
    kind = asked.door or "as told"
    if kind not in ("unattainable", "end of horizon"):
        return RefusalReason(kind)
    mean_kw = asked.need_kwh * 60 / run.scenario.interval_minutes
    return RefusalReason(
        kind,
        need_kwh=asked.need_kwh,
        max_kw=asked.max_kw,
        low_kw=min(asked.min_kw, mean_kw),
        intervals=math.ceil(mean_kw / asked.max_kw - ROUNDING),
        left=asked.deadline - asked.first,
    )


def _may_be_short(run: RunRecord, asked: Asked) -> bool:
    """Whether any contract made before was changed and not over when a vehicle asked."""
    first = {name: one.first for name, one in run.asked.items()}
    return any(
        entry.cause and first.get(entry.vehicle, 0) < asked.first < entry.promised_by_interval
        for entry in run.ledger
    )


def _refused(
    run: RunRecord, moment: Moment, one: Owed, row: VehicleRow, *, fallback: bool
) -> Iterator[str]:
    """A refusal past the door: kept for want of another plan, too dear, no headroom, outbid."""
    kind = kind_of(row.reason)
    if fallback != (kind == "fallback"):
        yield f"{one.vehicle}: reason is {row.reason!r}, its interval a fallback: {fallback}"
    if fallback or kind is None:
        return
    policy, window = run.summary.get("policy"), slice(one.first, one.deadline)
    hours = run.scenario.interval_minutes / 60
    alone = lowest_cost(one, moment.known.price_per_kwh[window], hours)
    dear = RefusalReason("energy", cost=alone, pays=one.revenue, need_kwh=one.owed_kwh)
    is_near = abs(alone - one.revenue) <= NEAR_USD
    if policy in SEEKS_PROFIT and alone >= one.revenue - NEAR_USD:
        if row.reason != str(dear) and not is_near:
            yield f"{one.vehicle}: reason is {row.reason!r}, worked out again {dear}"
        return
    if kind == "energy":
        yield f"{one.vehicle}: reason is {row.reason!r}, yet its energy costs {alone:.2f} $ alone"
    if policy != "oracle" and moment.is_last_word and len(run.intervals) == run.scenario.intervals:
        yield from _by_feeder(run, one, row, kind)
    if kind == "outbid" and not _names_some(row.reason, moment.admitted):
        yield f"{one.vehicle}: reason is {row.reason!r}, which names nobody admitted beside it"


def _elements(scenario: Scenario, names: Iterable[str]) -> Iterator[Element]:
    """The elements of some names; those that name none are found fault with elsewhere."""
    for name in names:
        with suppress(ValueError):
            yield scenario.rated_elements.get(name) or Element.read(name)


def _by_feeder(run: RunRecord, one: Owed, row: VehicleRow, kind: RefusalKind) -> Iterator[str]:
    """Whether a vehicle alone fits under the headroom, which is known as nothing happens later."""
    told = run.intervals[one.first : one.deadline]
    room_kw = np.array([math.inf if r.headroom_kw is None else r.headroom_kw for r in told])
    mean_kw = one.owed_kwh * 60 / run.scenario.interval_minutes
    short = Counter(
        r.binding for r, room in zip(told, room_kw, strict=True) if room < min(one.max_kw, mean_kw)
    )
    named = _elements(run.scenario, [name for name, _ in short.most_common()])
    feeder = RefusalReason("feeder", elements=tuple(named))
    tight, wide = (_fits(one, room_kw + slack, mean_kw) for slack in (-ROUNDING_KW, ROUNDING_KW))
    if not wide and row.reason != str(feeder):
        yield f"{one.vehicle}: reason is {row.reason!r}, worked out again {feeder}"
    if tight and kind == "feeder":
        yield f"{one.vehicle}: reason is {row.reason!r}, yet the feeder can carry it alone"


def _fits(one: Owed, room_kw: Floats, mean_kw: float) -> bool:
    """Whether intervals with so much room, (intervals,) in kW, hold its energy, alone."""
    lowest, most = min(one.min_kw, mean_kw), min(one.max_kw, mean_kw)
    reached = 0.0
    for count, room in enumerate(sorted(room_kw.tolist(), reverse=True), 1):
        if room < lowest - ROUNDING or count * lowest > mean_kw + ROUNDING:
            return False
        reached += min(most, room)
        if reached >= mean_kw - ROUNDING:
            return True
    return False


def lowest_cost(one: Owed, price_per_kwh: Floats, hours: float) -> float:
    """The least its energy costs in these intervals, (intervals,), to itself, $.

    Of so many intervals the cheapest are best, each at the lowest power at least; what is left
    goes into the cheapest of them.
    """
    mean_kw = one.owed_kwh / hours
    lowest, most = min(one.min_kw, mean_kw), min(one.max_kw, mean_kw)
    prices, best = sorted(price_per_kwh.tolist()), math.inf
    for count in range(1, len(prices) + 1):
        left = mean_kw - count * lowest
        if left < -ROUNDING:
            break
        cost = lowest * math.fsum(prices[:count])
        for price in prices[:count]:
            more = min(max(0.0, left), most - lowest)
            cost, left = cost + price * more, left - more
        if left <= ROUNDING:
            best = min(best, cost * hours)
    return best


def _names_some(reason: str, admitted: frozenset[str]) -> bool:
    """Whether the figures of a reason begin with somebody admitted."""
    _, _, named = reason.partition(": ")
    return any(named == one or named.startswith((f"{one}, ", f"{one} and ")) for one in admitted)
