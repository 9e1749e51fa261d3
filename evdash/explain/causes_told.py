"""A cause in a sentence: the reason's own clause, then its numbers, units and clock times."""

from collections.abc import Callable, Mapping

from evdash.domain.elements import Element
from evdash.domain.refusal import RefusalKind
from evdash.domain.vehicles import Request
from evdash.domain.words import element_words, some_money
from evdash.explain.causes import Cause
from evdash.explain.trials import Trials
from evdash.explain.words import clock_of, counted, listed

NAMED = 5


def cause_told(trials: Trials, cause: Cause) -> str:
    """Why the vehicle was refused: one sentence."""
    return f"Refused because {_told(trials, cause)}."


def p1_told(trials: Trials, cause: Cause | None) -> str:
    """What P1 would have answered where it was not P1 that refused; None: yes."""
    if cause is None:
        return "P1, asked at that moment, would have admitted it."
    return f"P1, asked at that moment, would have refused it because {_told(trials, cause)}."


def _told(trials: Trials, cause: Cause) -> str:
    tell = _TELLING.get(cause.kind)
    more = tell(trials, cause) if tell else ""
    return f"{cause.reason.clause}{': ' if more else ''}{more}{_THEN[cause.then]}"


def _after_the_end(trials: Trials, _: Cause) -> str:
    request, end = trials.request, clock_of(trials).end(trials.inputs.scenario.intervals - 1)
    return (
        f"it came at {request.arrival:%H:%M}, and its {request.need_kwh:.1f} kWh could be charged "
        f"from {end} on, when the horizon ends"
    )


def _figures(_: Trials, cause: Cause) -> str:
    return cause.reason.figures


def _end_of_horizon(trials: Trials, _: Cause) -> str:
    request, clock = trials.request, clock_of(trials)
    end = clock.end(trials.inputs.scenario.intervals - 1)
    most = trials.window * request.max_kw * trials.snapshot.interval_hours
    return (
        f"it ends at {end}; the vehicle needs {request.need_kwh:.1f} kWh and takes at most "
        f"{request.max_kw:g} kW, which makes {most:.1f} kWh in the {clock.lasting(trials.window)} "
        "left"
    )


def _price(trials: Trials, cause: Cause) -> str:
    request, reason = trials.request, cause.reason
    station = {
        "energy": "at an empty station and without any limit of the feeder",
        "feeder cost": "at an empty station",
        "contracts cost": f"{_beside(trials)}",
    }[reason.kind]
    cheapest = float(trials.snapshot.price_per_kwh[: trials.window].min())
    told = (
        f"{station} its {request.need_kwh:.1f} kWh would add at least {some_money(reason.cost)} "
        f"({reason.cost / request.need_kwh:.4g} $/kWh) before its return at {_return(trials)}, "
        f"and it pays {some_money(request.revenue)} ({request.price_per_kwh:g} $/kWh)"
    )
    if cheapest >= request.price_per_kwh:
        return f"{told}; even its cheapest hour costs {cheapest:.4g} $/kWh"
    return told


def _displaced(trials: Trials, cause: Cause) -> str:
    names = _named(cause.displaced_by)
    one = len(cause.displaced_by) == 1
    told = f"it would have come in if {names} {'had' if one else 'had all'} not come"
    if not cause.only_by:
        told = f"beside the others admitted then, {told}"
    if cause.loss is None:
        return told
    return (
        f"{told}; admitting it (it pays {some_money(trials.request.revenue)}) would have lowered "
        f"the profit by {some_money(max(0.0, cause.loss))}"
    )


def _feeder(trials: Trials, cause: Cause) -> str:
    return f"{_headroom_taken(trials, cause)}{_pace(trials, cause)}"


def _headroom(trials: Trials, cause: Cause) -> str:
    return f"{_headroom_taken(trials, cause)} {_beside(trials)}{_pace(trials, cause)}"


def _chargers(trials: Trials, cause: Cause) -> str:
    return f"{_chargers_taken(trials, cause)} {_taken_by(trials)}"


def _either(trials: Trials, cause: Cause) -> str:
    return f"{_room_taken(trials, cause)} {_beside(trials)}{_pace(trials, cause)}"


def _pace(trials: Trials, cause: Cause) -> str:
    """Where energy would do and its own charger does not."""
    if not cause.by_pace:
        return ""
    return (
        f"; in energy there is room for its {trials.request.need_kwh:.1f} kWh before "
        f"{_return(trials)}, but not at the pace of its own {trials.request.max_kw:g} kW"
    )


_THEN = {
    "": "",
    "displaced": "; with enough of it newcomers who earn more would still have come first",
    "price": "; with enough of it its energy would still have cost no less than it pays",
}
_TELLING: Mapping[RefusalKind, Callable[[Trials, Cause], str]] = {
    "after the end": _after_the_end,
    "unattainable": _figures,
    "end of horizon": _end_of_horizon,
    "energy": _price,
    "feeder cost": _price,
    "contracts cost": _price,
    "feeder": _feeder,
    "headroom": _headroom,
    "chargers": _chargers,
    "headroom or chargers": _either,
    "headroom and chargers": _either,
    "outbid": _displaced,
    "kept for others": _figures,
    "rule": _figures,
    "policy": _figures,
    "fallback": _figures,
}


def _return(trials: Trials) -> str:
    return clock_of(trials).end(trials.request.deadline_interval - 1)


def _named(requests: tuple[Request, ...]) -> str:
    told = [f"{r.vehicle} ({some_money(r.revenue)})" for r in requests[:NAMED]]
    more = len(requests) - len(told)
    return listed([*told, f"{more} more"] if more else told)


def _headroom_taken(trials: Trials, cause: Cause) -> str:
    clock, scenario = clock_of(trials), trials.inputs.scenario
    by_element: dict[Element | None, list[int]] = {}
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
