"""A cause in a sentence, with its numbers, units and clock times."""

from collections.abc import Callable, Mapping

from evdash.domain.vehicles import Request
from evdash.explain.causes import Cause, CauseKind
from evdash.explain.trials import Trials
from evdash.explain.words import clock_of, counted, element_words, listed, money

NAMED = 5


def cause_told(trials: Trials, cause: Cause) -> str:
    """Why the vehicle was refused: one sentence."""
    return f"Refused because {_TELLING[cause.kind](trials, cause)}{_THEN[cause.then]}."


def _after_the_end(trials: Trials, _: Cause) -> str:
    request, end = trials.request, clock_of(trials).end(trials.inputs.scenario.intervals - 1)
    return (
        f"it came at {request.arrival:%H:%M}, after the last interval had begun: its "
        f"{request.need_kwh:.1f} kWh could be charged from {end} on, when the horizon ends"
    )


def _no_chargers(_: Trials, __: Cause) -> str:
    return "the station has no chargers"


def _unattainable(trials: Trials, _: Cause) -> str:
    reason = trials.request.refusal.removeprefix("unattainable: ")
    return f"no whole number of intervals can give what it needs: {reason}"


def _end_of_horizon(trials: Trials, _: Cause) -> str:
    request, clock = trials.request, clock_of(trials)
    end = clock.end(trials.inputs.scenario.intervals - 1)
    most = trials.window * request.max_kw * trials.snapshot.interval_hours
    return (
        f"there is too little time before the horizon's end at {end}: it needs "
        f"{request.need_kwh:.1f} kWh and takes at most {request.max_kw:g} kW, which makes "
        f"{most:.1f} kWh in the {clock.lasting(trials.window)} left"
    )


def _price(trials: Trials, cause: Cause) -> str:
    request, window = trials.request, trials.window
    cheapest = float(trials.snapshot.price_per_kwh[:window].min())
    if cause.energy_cost is None:
        return "energy is dearer than its price: even alone it would not have been worth its cost"
    cost = cause.energy_cost
    told = (
        f"energy is dearer than its price: beside the contracts alone its "
        f"{request.need_kwh:.1f} kWh would have cost {money(cost)} "
        f"({cost / request.need_kwh:.4g} $/kWh) before its return at {_return(trials)}, and it "
        f"pays {money(request.revenue)} ({request.price_per_kwh:g} $/kWh)"
    )
    if cheapest >= request.price_per_kwh:
        return f"{told}; even its cheapest hour costs {cheapest:.4g} $/kWh"
    return told


def _displaced(trials: Trials, cause: Cause) -> str:
    names = _named(cause.displaced_by) or "other newcomers"
    one = len(cause.displaced_by) == 1
    told = (
        f"newcomers who pay better took its place: it would have been admitted if {names} "
        f"{'had' if one else 'had all'} not come"
    )
    if cause.loss is None:
        return told
    return (
        f"{told}; admitting it (it pays {money(trials.request.revenue)}) would have lowered the "
        f"profit by {money(max(0.0, cause.loss))}"
    )


def _headroom(trials: Trials, cause: Cause) -> str:
    return f"of headroom: {_headroom_taken(trials, cause)} {_beside(trials)}"


def _chargers(trials: Trials, cause: Cause) -> str:
    return f"of chargers: {_chargers_taken(trials, cause)} {_taken_by(trials)}"


def _either(trials: Trials, cause: Cause) -> str:
    return (
        f"of headroom and chargers: {_room_taken(trials, cause)} {_beside(trials)}; "
        "more of either would make room"
    )


def _both(trials: Trials, cause: Cause) -> str:
    return (
        f"of headroom and chargers together: {_room_taken(trials, cause)} {_beside(trials)}; "
        "more of only one of them would make no room"
    )


def _time(trials: Trials, cause: Cause) -> str:
    request = trials.request
    cut = request.deadline_interval == trials.inputs.scenario.intervals
    by = "the horizon's end" if cut else "its return"
    return (
        f"there is too little time before {by} at {_return(trials)}: in energy there is "
        f"room for its {request.need_kwh:.1f} kWh, but not at the pace of its own "
        f"{request.max_kw:g} kW; {_room_taken(trials, cause)} {_beside(trials)}"
    )


def _promises_short(_: Trials, __: Cause) -> str:
    return (
        "something happened by which promises already made cannot all be kept; until that is "
        "over nobody new is admitted"
    )


def _not_p1(trials: Trials, _: Cause) -> str:
    return "the plan in force was not made by P1, which would have admitted it"


def _not_known(trials: Trials, _: Cause) -> str:
    return "the plan did not admit it; the solver found no answer as to why"


_THEN = {
    "": "",
    "displaced": "; with enough of it newcomers who pay better would still have come first",
    "price": "; with enough of it its energy would still have cost more than it pays",
}
_TELLING: Mapping[CauseKind, Callable[[Trials, Cause], str]] = {
    "after the end": _after_the_end,
    "no chargers": _no_chargers,
    "unattainable": _unattainable,
    "end of horizon": _end_of_horizon,
    "price": _price,
    "displaced": _displaced,
    "headroom": _headroom,
    "chargers": _chargers,
    "headroom or chargers": _either,
    "headroom and chargers": _both,
    "time": _time,
    "promises short": _promises_short,
    "not P1": _not_p1,
    "not known": _not_known,
}


def _return(trials: Trials) -> str:
    return clock_of(trials).end(trials.request.deadline_interval - 1)


def _named(requests: tuple[Request, ...]) -> str:
    told = [f"{r.vehicle} ({money(r.revenue)})" for r in requests[:NAMED]]
    more = len(requests) - len(told)
    return listed([*told, f"{more} more"] if more else told)


def _headroom_taken(trials: Trials, cause: Cause) -> str:
    clock, scenario = clock_of(trials), trials.inputs.scenario
    by_element: dict[str, list[int]] = {}
    for interval, element in cause.taken.headroom:
        by_element.setdefault(element, []).append(interval)
    told = [
        f"{clock.spans(intervals)} {element_words(element, scenario)}"
        for element, intervals in by_element.items()
    ]
    verb = "leaves" if len(told) == 1 else "leave"
    return f"{listed(told) or 'the feeder'} {verb} too little room"


def _chargers_taken(trials: Trials, cause: Cause) -> str:
    count, hours = trials.snapshot.chargers, clock_of(trials).spans(cause.taken.chargers)
    whose = "the only charger is" if count == 1 else f"all {count} chargers are"
    return f"{hours} {whose} needed" if hours else f"{whose} needed"


def _room_taken(trials: Trials, cause: Cause) -> str:
    parts = [_chargers_taken(trials, cause)] * bool(cause.taken.chargers)
    parts += [_headroom_taken(trials, cause)] * bool(cause.taken.headroom)
    return listed(parts) or "room is scarce"


def _beside(trials: Trials) -> str:
    made = len(trials.snapshot.contracts)
    return f"beside the {counted(made, 'contract')} already made" if made else "for it"


def _taken_by(trials: Trials) -> str:
    made = len(trials.snapshot.contracts)
    return f"by the {counted(made, 'contract')} already made" if made else "for longer than it has"
