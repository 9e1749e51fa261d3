"""One optimiser for everyone on this server: fair turns, and nothing solved twice.

Other policies are made for the day they decide, and take the same turns.
"""

import threading
from collections import OrderedDict, deque
from collections.abc import Iterator
from contextlib import contextmanager

from evdash.domain.digest import digest
from evdash.domain.plan import Plan, Policy, Snapshot
from evdash.domain.trace import PAPERS, Inputs, Trace
from evdash.horizon.day import Decide, certified_plan, run_day
from evdash.policies.registry import known
from evdash.scheduling.p1 import p1_answers, p1_plans, p1_policy

SLOTS = 2
MOST_PLANS = 500


class Turns:
    """Lets so many in at a time, first come first served, so that nobody's run starves others."""

    def __init__(self, slots: int) -> None:
        self._free = slots
        self._waiting: deque[threading.Event] = deque()
        self._lock = threading.Lock()

    @contextmanager
    def one(self) -> Iterator[None]:
        """Wait for a turn, and give it to the next in line afterwards."""
        with self._lock:
            ticket = threading.Event()
            if self._free > 0:
                self._free -= 1
                ticket.set()
            else:
                self._waiting.append(ticket)
        ticket.wait()
        try:
            yield
        finally:
            with self._lock:
                if self._waiting:
                    self._waiting.popleft().set()
                else:
                    self._free += 1


def shared(policy: Policy, turns: Turns, most_plans: int = MOST_PLANS) -> Policy:
    """The policy taking turns and remembering its latest plans.

    A snapshot decides its plan, so a class stepping the same scenario solves it once, and
    going back and forth shows the same plan again.
    """
    plans: OrderedDict[bytes, Plan] = OrderedDict()
    lock = threading.Lock()

    def remembered(snapshot: Snapshot) -> Plan:
        key = digest(snapshot)
        with lock:
            if key in plans:
                plans.move_to_end(key)
                return plans[key]
        with turns.one():
            plan = policy(snapshot)
        with lock:
            plans[key] = plan
            while len(plans) > most_plans:
                plans.popitem(last=False)
        return plan

    return remembered


TURNS = Turns(SLOTS)
policy: Policy = shared(p1_policy(), TURNS)
"""The paper's policy, shared by all sessions of this server."""
answers: Policy = shared(p1_answers(), TURNS)
"""P1's answers alone, for explanations: nobody follows those plans."""
study_policy: Policy = shared(p1_plans(), TURNS, most_plans=0)
"""The same in the same turns; remembers nothing, as no day of a study comes twice."""

MOST_MADE = 16
_made: OrderedDict[tuple[str, int], tuple[Inputs, Policy]] = OrderedDict()
_made_lock = threading.Lock()


def decider(trace: Trace) -> tuple[Policy, Decide]:
    """Who decides a day, ready to be asked, and how the answers come to count.

    Raises InputError where there is no such policy, or it cannot decide such a day, and
    SolverFailure where it could not be made.
    """
    if trace.policy == PAPERS:
        return policy, certified_plan
    rule, inputs = known(trace.policy), _made_for(trace)
    key = (rule.name, id(inputs))
    with _made_lock:
        found = _made.get(key)
    if found is None:  # made without the lock: an oracle's day is solved whole for it
        with TURNS.one():
            found = inputs, shared(_alone(rule.make(inputs)), TURNS)
    with _made_lock:
        found = _made.setdefault(key, found)  # the inputs are held, so that their id stays theirs
        _made.move_to_end(key)
        while len(_made) > MOST_MADE:
            _made.popitem(last=False)
    return found[1], rule.decide


def whole_day(trace: Trace) -> Trace:
    """The day run to its end by whoever decides it."""
    asked, decide = decider(trace)
    return run_day(trace, asked, decide=decide)


def _made_for(trace: Trace) -> Inputs:
    """What a policy is told of the day: as it began, or as it was last changed by hand.

    Events it learns of as they happen, like everybody; so a day run on the command line is the
    same day here.
    """
    given = trace.inputs.given.replacing(events=())
    alike = (
        step.inputs
        for step in trace.steps
        if step.inputs.network == trace.inputs.network
        and step.inputs.given.replacing(events=()) == given
    )
    return next(alike, trace.inputs)


def _alone(asked: Policy) -> Policy:
    """The policy asked by one at a time: some remember what they have foreseen."""
    lock = threading.Lock()

    def policy(snapshot: Snapshot) -> Plan:
        with lock:
            return asked(snapshot)

    return policy
