"""Any choice of vehicles, refused ones too: a chart and a table of them."""

from collections.abc import Mapping, Sequence

from evdash.charts.gantt import FRAME_PX, gantt
from evdash.charts.power_map import power_map
from evdash.charts.rows import rows_for
from evdash.charts.schedule import GANTT_MOST
from evdash.charts.style import Figure, clock
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.metrics.records import Fate, VehicleRecord

BAR_PX, LINE_PX = 15, 5
LEAST_LINES = 8
SHORTEST_PX, TALLEST_PX = 400, 2400
"""Of a map: lines thinner than LINE_PX rather than a chart taller than a hundred rows of text."""


def fleet_figure(
    trace: Trace, outlook: Outlook, records: Sequence[VehicleRecord], picked: str = ""
) -> Figure:
    """The vehicles recorded, in the order given: as bars, or beyond 60 as a heat map."""
    rows = rows_for(trace, records)
    if len(rows) > GANTT_MOST:
        height_px = min(TALLEST_PX, max(SHORTEST_PX, FRAME_PX + LINE_PX * len(rows)))
        return power_map(outlook, rows, height_px=height_px, picked=picked)
    lines = max(LEAST_LINES, len(rows))
    return gantt(
        outlook,
        [option.name for option in trace.scenario.option],
        rows,
        height_px=FRAME_PX + BAR_PX * lines,
        lines=lines,
        empty="No vehicle to show: nobody asked yet, or none answers to the filter",
        picked=picked,
    )


def fleet_table(
    records: Sequence[VehicleRecord],
    charging_kw: Mapping[str, float],
    statuses: Mapping[Fate, str],
    outlook: Outlook,
) -> list[dict[str, object]]:
    """The same as rows of a table, with what each pays and why it was refused."""
    dated = outlook.crosses_midnight
    return [
        {
            "Vehicle": record.vehicle,
            "Answer": statuses[record.fate],
            "Option": record.request.option,
            "Arrived": clock(record.request.arrival, with_date=dated),
            "Due back": clock(outlook.times[record.request.deadline_interval], with_date=dated),
            "Asks, kWh": round(record.request.need_kwh, 1),
            "Got, kWh": round(record.delivered_kwh, 1),
            "Done, %": _percent(record),
            "Now, kW": round(charging_kw.get(record.vehicle, 0.0), 1),
            "Pays, $": round(record.revenue, 2),
            "Why not": record.why_not,
        }
        for record in records
    ]


def _percent(record: VehicleRecord) -> int:
    """Of what its contract is for, rounded down: 100 means all."""
    if record.promised_kwh <= 0:
        return 100
    return int(100 * record.delivered_kwh / record.promised_kwh + 1e-6)


def fleet_alt(records: Sequence[VehicleRecord], outlook: Outlook) -> str:
    """The chart in one sentence."""
    refused = sum(record.status == "refused" for record in records)
    done = sum(record.status == "charged" for record in records)
    short = sum(bool(record.short_kwh) for record in records)
    broken = f", {short} short of their promise" if short else ""
    return (
        f"Chart of {len(records)} vehicles at {clock(outlook.clock)}, a line each: {done} charged "
        f"in full, {refused} refused{broken}; the window of each, energy charged and planned."
    )
