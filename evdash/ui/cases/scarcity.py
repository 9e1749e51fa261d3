"""Scarce: room on the feeder in the evening, chargers at night."""

from evdash.metrics.outlook import outlook
from evdash.ui.cases import figures as f
from evdash.ui.cases.case import Case, Claim, Figures, Press, Walk
from evdash.ui.cases.doing import Ask, Pick, StepUntil


def _evening(walk: Walk) -> Figures:
    hours = f.between(walk.after(1), "19:00", "20:00")
    step = hours[-1]
    return {
        "headroom_kw": f.headroom_kw(step),
        "station_kw": step.station_kw,
        "idle": step.inputs.scenario.station.chargers - f.in_use(step),
        "chargers": step.inputs.scenario.station.chargers,
        "asked": f.asked(hours),
        "refused": f.refused(hours),
        "by_headroom": f.refused(hours, "headroom"),
        "transformer_kw": outlook(walk.after(1)).station_rating_kw,
    }


def _two_chargers_fewer(walk: Walk) -> Figures:
    answer, last = walk.runs[3].answer, walk.after(3).steps[-1]
    return {
        "idle": last.inputs.scenario.station.chargers - f.in_use(last),
        "chargers": last.inputs.scenario.station.chargers,
        "planned": int(last.plan.charging[1:].max(initial=0)),
        "broken": len(answer.shortfalls) if answer else 0,
    }


def _night(walk: Walk) -> Figures:
    evening = f.between(walk.after(4), "19:00", "20:00")[-1]
    hours = f.between(walk.after(4), "22:00", "23:00")
    step = hours[-1]
    return {
        "chargers": step.inputs.scenario.station.chargers,
        "in_use": f.in_use(step),
        "headroom_kw": f.headroom_kw(step),
        "headroom_before_kw": f.headroom_kw(evening),
        "left_kw": f.headroom_kw(step) - step.station_kw,
        "by_chargers": f.refused(hours, "chargers"),
        "too_late": f.refused(hours, "end of horizon"),
        "refused": f.refused(hours),
    }


SCARCE = Case(
    "Chargers are free. Why is a vehicle refused?",
    "summer-weekday",
    "A summer weekday: chargers behind a transformer that the houses nearly fill in the evening.",
    (
        Press((StepUntil("20:00"),), "read what was decided for 19:00–20:00"),
        Press((Pick(),)),
        Press((Ask("fewer_chargers", "Remove 2 chargers"),), "read the answer"),
        Press((StepUntil("23:00"),), "read what was decided for 22:00–23:00"),
    ),
    (
        Claim(
            "**19:00–20:00.** The station draws all {headroom_kw:.0f} kW that the feeder leaves "
            "it, and {idle} of {chargers} chargers are idle. {refused} of the {asked} who ask are "
            "refused, all because contracts already made need the feeder's headroom.",
            _evening,
            lambda n: (
                n["idle"] >= 2
                and n["headroom_kw"] - n["station_kw"] < 0.05
                and n["headroom_kw"] < 0.2 * n["transformer_kw"]
                and 0 < n["refused"] == n["by_headroom"]
            ),
        ),
        Claim(
            "**Idle is not spare.** Two of the {idle} idle chargers cannot be taken away: later "
            "in the evening the plan needs all {chargers}, and {broken} contracts would break.",
            _two_chargers_fewer,
            lambda n: n["idle"] >= 2 and n["planned"] == n["chargers"] and n["broken"] > 1,
        ),
        Claim(
            "**22:00–23:00.** Now it is the other way round: all {chargers} chargers are in use, "
            "and {left_kw:.0f} of {headroom_kw:.0f} kW stay unused. Nobody is refused for want of "
            "headroom: {by_chargers} because contracts already made need the chargers, {too_late} "
            "because there is too little time before the day ends.",
            _night,
            lambda n: (
                n["in_use"] == n["chargers"]
                and n["left_kw"] >= 20
                and n["headroom_kw"] > n["headroom_before_kw"]
                and n["by_chargers"] > 0
                and n["too_late"] > 0
                and n["by_chargers"] + n["too_late"] == n["refused"]
            ),
        ),
    ),
    "A promise takes two things, a charger and room on the feeder. In the evening room is short, "
    "at night chargers are. What the station needs more of depends on the hour.",
)
