"""How far each of a few vehicles is charged, interval by interval: the paper's Fig. 3."""

from evdash.charts.rows import Row, rows_of
from evdash.charts.style import (
    CLEAR,
    FONT_PX,
    OUTLINE,
    SKY,
    WINDOW,
    Figure,
    clock,
    empty_note,
    figure,
    safe,
    value_axis,
)
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace

HEIGHT_PX = 380
STEPS, MOST_VEHICLES = 10, 8
LONGEST_NAME = 12


def chosen(trace: Trace) -> tuple[int, list[Row]]:
    """Ten intervals, and up to eight vehicles charged within them, those that took longest."""
    full = [row for row in rows_of(trace) if row.percent == 100 and max(row.power_kw) < trace.now]

    def inside(first: int) -> list[Row]:
        return [
            row
            for row in full
            if first <= row.request.arrival_interval and max(row.power_kw) < first + STEPS
        ]

    firsts = range(max(1, trace.now - STEPS + 1))
    best = max(firsts, key=lambda first: (len(inside(first)), -first))
    longest = sorted(inside(best), key=lambda row: -len(row.power_kw))[:MOST_VEHICLES]
    return best, sorted(longest, key=lambda row: row.request.arrival_interval)


def completion_figure(trace: Trace, outlook: Outlook) -> Figure:
    """A row a vehicle: where it was available, and percent of its charge after each interval."""
    first, rows = chosen(trace)
    times = outlook.times[first : first + STEPS + 1]
    bars: dict[str, list[object]] = {"base": [], "x": [], "y": [], "text": [], "hovertext": []}
    windows: dict[str, list[object]] = {"base": [], "x": [], "y": []}
    for y, row in enumerate(rows):
        begin, end = row.request.arrival_interval, row.request.deadline_interval
        windows["base"].append(begin - first)
        windows["x"].append(min(end, first + STEPS) - begin)
        windows["y"].append(y)
        for t, percent in percents(row, outlook).items():
            bars["base"].append(t - first)
            bars["x"].append(1)
            bars["y"].append(y)
            bars["text"].append(f"{percent:.0f}")
            bars["hovertext"].append(
                f"{safe(row.request.vehicle)}, {clock(outlook.times[t])}: "
                f"{row.power_kw[t]:.1f} kW, then {percent:.0f} % charged"
            )
    bar = {"type": "bar", "orientation": "h", "hovertemplate": "%{hovertext}<extra></extra>"}
    return figure(
        [
            bar
            | {"name": "Available", "width": 0.86, "hoverinfo": "skip", "hovertemplate": None}
            | {"marker": {"color": WINDOW, "line": {"color": OUTLINE, "width": 1}}}
            | windows,
            bar
            | {"name": "Charging, % done afterwards", "width": 0.62, "textposition": "inside"}
            | {"insidetextanchor": "middle", "textangle": 0, "textfont": {"color": "black"}}
            | {"marker": {"color": SKY, "line": {"color": CLEAR, "width": 0}}}
            | bars,
        ],
        HEIGHT_PX,
        barmode="overlay",
        xaxis={
            "title": {"text": "Clock time"},
            "range": [0, STEPS],
            "tickvals": list(range(len(times))),
            "ticktext": [clock(moment) for moment in times],
            "tickfont": {"size": FONT_PX - 2},
            "zeroline": False,
        },
        yaxis=value_axis(
            "",
            range=[max(len(rows), 4) - 0.5, -0.5],
            tickvals=list(range(len(rows))),
            ticktext=[safe(row.request.vehicle[:LONGEST_NAME]) for row in rows],
            showgrid=False,
        ),
        annotations=[] if rows else [empty_note("Nobody has been charged in full yet")],
    )


def percents(row: Row, outlook: Outlook) -> dict[int, float]:
    """Percent of the promised energy delivered by the end of each interval with power."""
    hours = (outlook.times[1] - outlook.start).total_seconds() / 3600
    done, told = 0.0, {}
    for t, power_kw in sorted(row.power_kw.items()):
        done += power_kw * hours
        told[t] = 100 * done / row.request.need_kwh
    return told


def completion_table(trace: Trace, outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table."""
    _, rows = chosen(trace)
    return [
        {
            "Vehicle": row.request.vehicle,
            "From": clock(outlook.times[t]),
            "Power, kW": round(row.power_kw[t], 2),
            "Charged, %": round(percent, 1),
        }
        for row in rows
        for t, percent in percents(row, outlook).items()
    ]


def completion_alt(trace: Trace) -> str:
    """The chart in one sentence."""
    _, rows = chosen(trace)
    return f"Bars of {len(rows)} vehicles over ten intervals, each with percent charged so far."
