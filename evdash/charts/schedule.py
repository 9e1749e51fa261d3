"""Who charges when, against what was promised: the paper's Fig. 3, as a Gantt chart."""

from evdash.charts.gantt import gantt
from evdash.charts.power_map import power_map
from evdash.charts.rows import rows_of
from evdash.charts.style import Figure, clock
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace

GANTT_MOST = 60
"""Beyond so many vehicles a bar is too thin to read and a heat map takes over."""
LEAST_ROWS = 12
"""The axis has room for so many rows at least."""
HEIGHTS_PX = {30: 470, 43: 600, GANTT_MOST: 760}
"""Height of the chart for up to so many rows; the lowest fits a laptop's window."""
TALL_PX = 760


def schedule_figure(trace: Trace, outlook: Outlook) -> Figure:
    """The Gantt chart, or a heat map where there are too many vehicles for bars."""
    rows = rows_of(trace)
    if len(rows) > GANTT_MOST:
        return power_map(outlook, rows, height_px=TALL_PX)
    return gantt(
        outlook,
        [option.name for option in trace.scenario.option],
        rows,
        height_px=next(px for most, px in HEIGHTS_PX.items() if len(rows) <= most),
        lines=max(LEAST_ROWS, len(rows)),
        empty="Nobody was admitted"
        if trace.is_over
        else "Vehicles appear here once they are admitted",
    )


def schedule_table(trace: Trace, outlook: Outlook) -> list[dict[str, object]]:
    """The same as rows of a table: one for each vehicle."""
    dated = outlook.crosses_midnight
    return [
        {
            "Vehicle": row.request.vehicle,
            "Option": row.request.option,
            "From": clock(outlook.times[row.request.arrival_interval], with_date=dated),
            "Promised by": clock(outlook.times[row.request.deadline_interval], with_date=dated),
            "Promised, kWh": round(row.promised_kwh, 2),
            "Delivered, kWh": round(row.delivered_kwh, 2),
            "Missing, kWh": round(row.short_kwh, 2),
            "Done, %": row.percent,
            "Intervals charged": sum(t < outlook.now for t in row.power_kw),
            "Intervals planned": sum(t >= outlook.now for t in row.power_kw),
        }
        for row in rows_of(trace)
    ]


def schedule_alt(trace: Trace, outlook: Outlook) -> str:
    """The chart in one sentence."""
    rows = rows_of(trace)
    done = sum(row.percent == 100 for row in rows)
    short = sum(bool(row.short_kwh) for row in rows)
    return (
        f"Chart of {len(rows)} vehicles under contract at {clock(outlook.clock)}, one row each: "
        f"promised window, energy charged and energy planned. {done} are fully charged"
        f"{f', {short} short of what they were promised' if short else ''}."
    )
