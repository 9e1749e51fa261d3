"""Every refusal with its reason and its remedy: one vehicle at a time, off the step's path.

Nothing here is called by a step. A day is explained vehicle by vehicle by a generator, which
can be left at any vehicle; one picked vehicle by `explain_vehicle`.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from evdash.domain.plan import Policy
from evdash.domain.refusal import RefusalReason
from evdash.domain.trace import PAPERS, Inputs, State, Step, Trace
from evdash.domain.vehicles import Request
from evdash.errors import SolverFailure
from evdash.explain.causes import OTHERS, Cause, at_the_door, cause_of, reason_by_p1
from evdash.explain.causes_told import cause_told, p1_told
from evdash.explain.changes import NOTHING, longer
from evdash.explain.remedies import NoRemedy, Remedy, later_return, remedies_of
from evdash.explain.remedies_told import remedies_told
from evdash.explain.terms import other_terms
from evdash.explain.trials import Plans, Trials
from evdash.horizon.advance import snapshot_of
from evdash.scheduling.p1 import p1_answers
from evdash.scheduling.refused import LEFT_OUT

P1S = (PAPERS, "p1-plain")
"""The policies that decide by P1."""
TOGETHER = 9
"""So many of those a step refused share what is solved: more would solve less, by fewer at a time.
Always the same, so that no answer depends on how many processes there are."""


@dataclass(frozen=True, slots=True)
class Explanation:
    """Why one vehicle was refused, and what would have admitted it.

    `detail` and `remedy` are sentences (`remedy` may be empty); `remedies` and `helpless`
    are what the second says, each of the changes sought being in one of them.
    """

    vehicle: str
    interval: int
    cause: Cause
    remedies: tuple[Remedy, ...]
    helpless: tuple[NoRemedy, ...]
    detail: str
    remedy: str

    @property
    def text(self) -> str:
        """Cause and remedy, one after the other."""
        return f"{self.detail} {self.remedy}".strip()


def explain_refusal(
    step: Step, vehicle: str, policy: Policy | None = None, decided_by: str = PAPERS
) -> Explanation:
    """Why a step refused a vehicle; `policy` solves P1 anew, by default as the run does.

    Of a day that another policy decided, by its name, what solving again adds is told as P1's.
    Raises ValueError if the step did not refuse it.
    """
    given = _given(step)
    if vehicle not in given:
        raise ValueError(f"{vehicle} was not refused in interval {step.interval}")
    trials = trials_of(step.inputs, step.before, vehicle, policy, _known(step))
    return _explained(trials, given[vehicle], decided_by)


def explain_vehicle(trace: Trace, vehicle: str, policy: Policy | None = None) -> Explanation:
    """Why a vehicle was refused, whenever that was; raises ValueError if it was not."""
    for step in trace.steps:
        if vehicle in {refusal.vehicle for refusal in step.plan.refused}:
            return explain_refusal(step, vehicle, policy, trace.policy)
    if vehicle in {request.vehicle for request in too_late(trace)}:
        trials = trials_of(trace.inputs, trace.state, vehicle, policy)
        return _explained(trials, None, trace.policy)
    raise ValueError(f"{vehicle} was not refused")


@dataclass(frozen=True, slots=True)
class Asked:
    """Some of those refused at one step, who share what is solved for all alike."""

    inputs: Inputs
    state: State
    vehicles: tuple[str, ...]
    known: Plans = field(default_factory=dict)
    given: Mapping[str, RefusalReason] = field(default_factory=dict)
    decided_by: str = PAPERS

    def explanations(self, policy: Policy | None = None) -> Iterator[Explanation]:
        """One after the other, each worked out when asked for."""
        plans = dict(self.known)
        for vehicle in self.vehicles:
            trials = trials_of(self.inputs, self.state, vehicle, policy, plans)
            yield _explained(trials, self.given.get(vehicle), self.decided_by)


def explained(asked: Asked) -> tuple[Explanation, ...]:
    """All of them, as another process is asked for it."""
    return tuple(asked.explanations())


def refused(trace: Trace) -> Iterator[Asked]:
    """Everyone refused so far, in order of arrival, in groups that several processes can share."""
    for step in trace.steps:
        vehicles = [refusal.vehicle for refusal in step.plan.refused]
        for group in _groups(vehicles):
            known, given = _known(step), _given(step)
            yield Asked(step.inputs, step.before, group, known, given, trace.policy)
    for group in _groups([request.vehicle for request in too_late(trace)]):
        yield Asked(trace.inputs, trace.state, group, decided_by=trace.policy)


def _groups(vehicles: Sequence[str]) -> Iterator[tuple[str, ...]]:
    for first in range(0, len(vehicles), TOGETHER):
        yield tuple(vehicles[first : first + TOGETHER])


def explanations(trace: Trace, policy: Policy | None = None) -> Iterator[Explanation]:
    """Everyone refused so far, in order of arrival; each is worked out when asked for."""
    for asked in refused(trace):
        yield from asked.explanations(policy)


def too_late(trace: Trace) -> tuple[Request, ...]:
    """Who came after the last interval had begun, once that is known."""
    return trace.inputs.requests[trace.scenario.intervals] if trace.is_over else ()


def _given(step: Step) -> dict[str, RefusalReason]:
    """The reasons a step gave, by vehicle."""
    return {refusal.vehicle: refusal.reason for refusal in step.plan.refused}


def _known(step: Step) -> Plans:
    """P1's own answer, where the step has it, need not be asked for again."""
    return {("", NOTHING): step.plan} if step.plan.report.status == "optimal" else {}


def trials_of(
    inputs: Inputs,
    state: State,
    vehicle: str,
    policy: Policy | None = None,
    plans: Plans | None = None,
) -> Trials:
    """What was known when a vehicle asked, ready to be solved again.

    Beyond the horizon's end a snapshot has no slots; it gets one, in which nobody may charge.
    """
    snapshot = longer(inputs, snapshot_of(inputs, state), 1)
    request = next(r for r in snapshot.requests if r.vehicle == vehicle)
    return Trials(inputs, snapshot, request, policy or p1_answers(), {} if plans is None else plans)


def _explained(trials: Trials, given: RefusalReason | None, decided_by: str) -> Explanation:
    """The explanation of the reason `given` at the step, or else at the door."""
    door, by_p1 = at_the_door(trials), decided_by in P1S
    reason = given if given is not None and given.kind != "as told" else door or given
    try:
        if door is not None:
            told = _worded(trials, Cause(door), _remedies_at_the_door(trials, door))
            return told if by_p1 else replace(told, remedy=_by_p1(told.remedy))
        if reason is None or reason.kind in OTHERS or not by_p1:
            return _by_others(trials, reason or LEFT_OUT)
        if trials.admits(NOTHING):
            return _worded(trials, Cause(reason), ())
        cause, remedies = cause_of(trials, reason), remedies_of(trials)
        return _worded(trials, _with_hours(trials, cause, remedies), remedies)
    except SolverFailure:
        if reason is not None and not by_p1:
            return _plainly(trials, reason)
        return _worded(trials, Cause(reason or LEFT_OUT), ())


def _by_others(trials: Trials, reason: RefusalReason) -> Explanation:
    """A refusal that is not P1's own: what refused it, and what P1 would have answered."""
    told = _plainly(trials, reason)
    if trials.admits(NOTHING):
        return replace(told, detail=f"{told.detail} {p1_told(trials, None)}")
    cause, remedies = cause_of(trials, reason_by_p1(trials)), remedies_of(trials)
    by_p1 = _worded(trials, _with_hours(trials, cause, remedies), remedies)
    detail = f"{told.detail} {p1_told(trials, by_p1.cause)}"
    return replace(by_p1, cause=Cause(reason), detail=detail, remedy=_by_p1(by_p1.remedy))


def _plainly(trials: Trials, reason: RefusalReason) -> Explanation:
    """A reason as it was given, with nothing that solving P1 again adds."""
    detail = f"Refused because {reason}."
    return Explanation(
        trials.vehicle, trials.snapshot.now, Cause(reason), (), (), detail, remedy=""
    )


def _by_p1(remedy: str) -> str:
    """What would have admitted it, where that is known of P1 alone."""
    return f"By P1: {remedy}" if remedy else ""


def _remedies_at_the_door(trials: Trials, door: RefusalReason) -> tuple[Remedy | NoRemedy, ...]:
    if door.kind == "promises short":
        return ()
    if door.kind == "after the end":
        return (later_return(trials),)
    return (*remedies_of(trials), *other_terms(trials))


def _with_hours(trials: Trials, cause: Cause, remedies: tuple[Remedy | NoRemedy, ...]) -> Cause:
    """The cause at the hours in which the least remedy is really used, where there is one."""
    taken, binding = cause.taken, trials.snapshot.rows.binding()
    for remedy in remedies:
        if not isinstance(remedy, Remedy) or not remedy.intervals:
            continue
        if remedy.kind == "headroom" and taken.headroom:
            now = trials.snapshot.now
            taken = replace(taken, headroom=tuple((t, binding[t - now]) for t in remedy.intervals))
        if remedy.kind == "chargers" and taken.chargers:
            taken = replace(taken, chargers=remedy.intervals)
    return replace(cause, taken=taken)


def _worded(trials: Trials, cause: Cause, remedies: tuple[Remedy | NoRemedy, ...]) -> Explanation:
    return Explanation(
        vehicle=trials.vehicle,
        interval=trials.snapshot.now,
        cause=cause,
        remedies=tuple(r for r in remedies if isinstance(r, Remedy)),
        helpless=tuple(r for r in remedies if isinstance(r, NoRemedy)),
        detail=cause_told(trials, cause),
        remedy=remedies_told(trials, remedies),
    )
