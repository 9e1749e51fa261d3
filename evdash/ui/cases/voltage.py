"""A limit elsewhere: a voltage at another node, and what losses take."""

from evdash.metrics.service import totals
from evdash.ui.cases import figures as f
from evdash.ui.cases.case import Case, Claim, Figures, Press, Walk
from evdash.ui.cases.doing import Finish, Limits, Reset
from evdash.ui.words import element_words


def _station_of_many(walk: Walk) -> Figures:
    steps = f.between(walk.after(1), "00:00")
    full = [step for step in steps if f.is_nearly_full(step)]
    least = min(full or steps, key=f.headroom_kw)
    kinds = {found.kind for step in full if (found := f.binding(step))}
    return {
        "chargers": walk.after(1).scenario.station.chargers,
        "in_use": max(f.in_use(step) for step in steps),
        "hours": len(full),
        "When": f.when(full).capitalize(),
        "share": 100 * f.FULL,
        "least_kw": f.headroom_kw(least),
        "at": f"{least.start:%H:%M}",
        "element": element_words(f.binding(least), least.inputs.scenario),
        "by_voltage": kinds == {"voltage_min"},
    }


def _behind(walk: Walk) -> Figures:
    trace = walk.after(1)
    step = min(trace.steps, key=f.headroom_kw)
    found = f.binding(step)
    node = "" if found is None else found.node
    behind = found is not None and found.kind == "voltage_min" and f.is_behind(trace, node)
    return {"node": node, "station": trace.scenario.station.node, "behind": behind}


def _with_losses(walk: Walk) -> Figures:
    linear, ac = (f.between(walk.after(press), "00:00") for press in (1, 2))
    more = [f.headroom_kw(a) - f.headroom_kw(b) for a, b in zip(linear, ac, strict=True)]
    no_room = f.when([step for step in ac if f.headroom_kw(step) < 0.05])
    return {
        "When": no_room.capitalize(),
        "too_low": f.when(f.too_low_by_itself(walk.after(2))) == no_room != "never",
        "least_more_kw": min(more),
        "linear": totals(walk.after(1)).admitted,
        "ac": totals(walk.after(2)).admitted,
    }


VOLTAGE = Case(
    "Whose limit is it: a line's, or a voltage?",
    "voltage-limited",
    "A station with far more chargers than are ever in use, on a heavily loaded feeder.",
    (
        Press((Finish(),), "open **What binds, and when**"),
        Press((Limits("ac"), Reset(), Finish()), "compare how many are admitted"),
    ),
    (
        Claim(
            "**No charger is short:** at most {in_use} of {chargers} are in use. {When} the "
            "station draws {share:.0f} % or more of what the feeder leaves it; at {at} {element} "
            "leaves just {least_kw:.0f} kW.",
            _station_of_many,
            lambda n: (
                n["in_use"] < n["chargers"] / 2
                and n["hours"] >= 2
                and n["by_voltage"]
                and 0 < n["least_kw"] < 60
            ),
        ),
        Claim(
            "**The limit is elsewhere:** the station is at node {station}, the voltage at node "
            "{node}. What {node} draws comes past {station}, so charging lowers its voltage, too.",
            _behind,
            lambda n: bool(n["behind"]),
        ),
        Claim(
            "**In full AC** losses count, and every hour has less room. {When} there is none: the "
            "voltage is too low without a single vehicle. {ac} are admitted in place of {linear}.",
            _with_losses,
            lambda n: n["too_low"] and n["least_more_kw"] > 0 and n["ac"] < 0.8 * n["linear"],
        ),
    ),
    "Current lowers the voltage all along its way, for everybody behind. The linearised model "
    "leaves out losses: it sees voltages higher than they are, and room that is not there.",
)
