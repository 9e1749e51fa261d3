"""Something happens: events become known, and what was promised is settled anew."""

from collections.abc import Sequence
from dataclasses import replace

from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Happening, Trace
from evdash.errors import Fault, InputError
from evdash.horizon.inputs import prepare_from
from evdash.horizon.recourse import SHED, UNPROVEN, settle


def happen(trace: Trace, events: Sequence[Event]) -> Trace:
    """The day with `events` known now; its last happening tells which contracts they changed.

    The trace given stays as it was, so that what an event would do can be seen before it is
    taken for true. Events become part of the scenario: run again, the day has them at the
    same time. Raises InputError for events of another interval, or once the day is over.
    """
    faults = [
        Fault("events", f"interval {event.interval}", f"should be {trace.now}, the present one")
        for event in events
        if event.interval != trace.now or trace.is_over
    ]
    if faults:
        raise InputError(faults)
    given = trace.inputs.given
    return _settled(trace, given.replacing(events=(*given.events, *events)), tuple(events))


def reached(trace: Trace) -> Trace:
    """The day with what its scenario has happen at the interval just reached."""
    due = tuple(e for e in trace.inputs.given.events if e.interval == trace.now)
    return _settled(trace, trace.inputs.given, due) if due and not trace.is_over else trace


def undone(trace: Trace) -> Trace:
    """Before the last step, under the inputs it was decided with; what came later is undone."""
    last = trace.steps[-1]
    known = tuple(h for h in trace.happenings if h.interval <= last.interval)
    return replace(
        trace, inputs=last.inputs, state=last.before, steps=trace.steps[:-1], happenings=known
    )


def _settled(trace: Trace, given: Scenario, events: tuple[Event, ...]) -> Trace:
    inputs = prepare_from(given, trace.inputs.network, trace.inputs, trace.now)
    settled = settle(inputs, trace.state, events)
    happening = Happening(
        interval=trace.now,
        events=events,
        revisions=settled.revisions,
        after=settled.state,
        note=". ".join(settled.notes),
        proven=not {SHED, UNPROVEN} & set(settled.notes),
    )
    happenings = (*trace.happenings, happening)
    return replace(trace, inputs=inputs, state=settled.state, happenings=happenings)
