"""Who asked, who was admitted, who was refused: the paper's Fig. 2."""

from evdash.charts.style import (
    GREEN,
    MARGIN,
    OUTLINE,
    VERMILLION,
    Figure,
    clock,
    empty_note,
    fixed_figure,
    now_label,
    now_shapes,
    spans,
    stamp,
    time_axis,
    value_axis,
)
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace

HEIGHT_PX = 330
REFUSED_LOOK = {
    "line": {"color": VERMILLION, "width": 1.5},
    "pattern": {"shape": "x", "size": 7, "fgcolor": VERMILLION, "bgcolor": "rgba(213,94,0,0.15)"},
}
LEAST_VEHICLES = 5
"""The axis reaches at least so far, so that the first hours do not rescale it each time."""


def admissions_figure(trace: Trace, outlook: Outlook) -> Figure:
    """Admitted and refused stacked per interval, and how many were there to choose from."""
    times = outlook.times[: outlook.now]
    minutes = trace.scenario.interval_minutes
    asked = [len(step.requests) for step in trace.steps]
    admitted = [len(step.plan.admitted) for step in trace.steps]
    refused = [len(step.plan.refused) for step in trace.steps]
    whole: dict[str, object] = {
        "type": "bar",
        "x": [stamp(time) for time in times],
        "offset": minutes * 60_000 * 0.08,
        "width": minutes * 60_000 * 0.84,
        "customdata": spans(outlook)[: outlook.now],
    }
    traces: list[dict[str, object]] = [
        whole
        | {"name": "Admitted", "y": admitted, "marker": {"color": GREEN}}
        | {"hovertemplate": "%{customdata}: %{y} admitted<extra></extra>"},
        whole
        | {"name": "Refused", "y": [count or None for count in refused]}
        | {"marker": REFUSED_LOOK}
        | {"hovertemplate": "%{customdata}: %{y} refused<extra></extra>"},
        {
            "type": "scatter",
            "mode": "markers",
            "name": "Asked",
            "x": [stamp(a + (b - a) / 2) for a, b in zip(times, outlook.times[1:], strict=False)],
            "y": [count or None for count in asked],
            "customdata": whole["customdata"],
            "marker": {"symbol": "diamond-open", "size": 9, "color": OUTLINE, "line": {"width": 2}},
            "hovertemplate": "%{customdata}: %{y} asked<extra></extra>",
        },
    ]
    per = "hour" if minutes == 60 else f"{minutes} min"
    return fixed_figure(
        traces,
        HEIGHT_PX,
        MARGIN,
        barmode="stack",
        xaxis=time_axis(outlook),
        yaxis=value_axis(
            f"Vehicles per {per}",
            range=[0, 1.08 * max([LEAST_VEHICLES, *asked])],
            tickformat="d",
            nticks=6,
        ),
        shapes=now_shapes(outlook),
        annotations=[now_label(outlook) if outlook.now else empty_note("Nobody has asked yet")],
    )


def admissions_table(trace: Trace, outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table."""
    return [
        {
            "Interval": span,
            "Asked": len(step.requests),
            "Admitted": len(step.plan.admitted),
            "Refused": len(step.plan.refused),
        }
        for span, step in zip(spans(outlook), trace.steps, strict=False)
    ]


def admissions_alt(trace: Trace, outlook: Outlook) -> str:
    """The chart in one sentence."""
    asked = sum(len(step.requests) for step in trace.steps)
    admitted = sum(len(step.plan.admitted) for step in trace.steps)
    return (
        f"Stacked bars of vehicles admitted and refused per interval until "
        f"{clock(outlook.clock)}: {admitted} of {asked} admitted."
    )
