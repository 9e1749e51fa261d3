"""One vehicle's contract in plain words. Text for Streamlit's Markdown; user text is escaped."""

import math
from collections.abc import Mapping, Sequence

from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.explain.revisions import Move, moves_between
from evdash.metrics.records import Fate, VehicleRecord
from evdash.metrics.vehicles import VehicleDay
from evdash.ui.words import clock, counted, money, plain

TOLD_KWH = 0.05
"""Less than this is not told as a change of plan."""
FATES: Mapping[Fate, str] = {
    "charged": ":green-badge[:material/check: charged in full]",
    "charging": ":blue-badge[:material/bolt: under contract]",
    "refused": ":red-badge[:material/block: refused]",
    "short": ":red-badge[:material/warning: promise cannot be kept]",
    "broken": ":red-badge[:material/warning: contract broken]",
    "released": ":gray-badge[:material/logout: cut short by its driver]",
}
STATUS_CELLS: Mapping[Fate, str] = {
    "charged": "✓ charged",
    "charging": "… under contract",
    "refused": "✗ refused",
    "short": "! short",
    "broken": "! broken",
    "released": "~ cut short by its driver",
}


def title(record: VehicleRecord) -> str:
    """Its name and what has become of it so far."""
    return f"#### {plain(record.vehicle)} &nbsp; {FATES[record.fate]}"


def contract_lines(day: VehicleDay, scenario: Scenario, outlook: Outlook) -> list[str]:
    """What it asked, what it was promised, what it pays, and how far that has come."""
    request = day.request
    option = scenario.options_by_name.get(request.option)
    pace = f", promised at {option.average_kw:g}\u00a0kW on average" if option else ""
    by = clock(outlook.times[request.deadline_interval], outlook)
    asked = (
        f"**Asked** at {clock(request.arrival, outlook)} for **{request.need_kwh:.1f}\u00a0kWh** "
        f"from the grid, to bring its {request.battery_kwh:g}\u00a0kWh battery from "
        f"{100 * request.soc_in:.0f}\u00a0% to {100 * request.soc_out:.0f}\u00a0%. It chose "
        f"option **{plain(request.option)}**: {price(request.price_per_kwh)} per kWh{pace}. "
        f"It takes at most {request.max_kw:g}\u00a0kW."
    )
    if not day.is_admitted:
        return [
            asked,
            f"**Answer: no.** It would have been due back by {by} and paid "
            f"{money(request.revenue)}.",
        ]
    return [asked, _promise(day, by, outlook), *ledger_lines(day, outlook), _so_far(day)]


def ledger_lines(day: VehicleDay, outlook: Outlook) -> list[str]:
    """What events changed in the contract since; nothing where it stands as made."""
    if day.terms is None:
        return []
    lines = []
    for change in day.terms.changes:
        by = clock(outlook.times[change.deadline_interval], outlook)
        told = [f"{change.promised_kwh:.1f}\u00a0kWh by {by}"]
        if change.more_kwh > TOLD_KWH:
            told.append(f"{change.more_kwh:.1f}\u00a0kWh more than before")
        if change.more_kwh < -TOLD_KWH:
            told.append(f"{-change.more_kwh:.1f}\u00a0kWh given up by its driver")
        if change.short_kwh > TOLD_KWH:
            told.append(f":red[**{change.short_kwh:.1f}\u00a0kWh of it cannot be kept**]")
        if change.short_kwh < -TOLD_KWH:
            told.append(f"{-change.short_kwh:.1f}\u00a0kWh made good again")
        at = clock(outlook.times[change.interval], outlook)
        lines.append(f"**Changed** at {at}, because {plain(change.text)}: {', '.join(told)}.")
    if day.terms.short_kwh > 0:
        lines.append(
            f":red[:material/warning: **Short by {day.terms.short_kwh:.1f}\u00a0kWh** of the "
            f"{day.terms.revised_kwh:.1f}\u00a0kWh agreed.]"
        )
    return lines


def _promise(day: VehicleDay, by: str, outlook: Outlook) -> str:
    request = day.request
    admitted = clock(outlook.times[request.arrival_interval], outlook)
    pays = day.record.revenue
    for_what = {
        "broken": ", for what it got",
        "released": ", for what it got",
        "short": ", for what it can get as things stand",
    }
    return (
        f"**Promised** at {admitted}: all of it **by {by}**. It pays **{money(pays)}**"
        f"{for_what.get(day.record.fate, '')}."
    )


def _so_far(day: VehicleDay) -> str:
    record = day.record
    got = f"{record.delivered_kwh:.1f} of {record.promised_kwh:.1f}\u00a0kWh"
    share = int(100 * day.share_delivered + 1e-6)
    cost = f"its energy cost the station {money(day.energy_cost)} so far"
    if record.status == "charged":
        left = record.revenue - day.energy_cost
        return (
            f"**Done:** it has all {record.promised_kwh:.1f}\u00a0kWh. The energy cost the "
            f"station {money(day.energy_cost)}; {money(left)} of what it pays is left."
        )
    return f"**So far** {got} delivered ({share}\u00a0%); {cost}."


def price(usd_per_kwh: float) -> str:
    """A price, `$0.35`; the dollar sign escaped."""
    digits = 2 if math.isclose(usd_per_kwh, round(usd_per_kwh, 2), abs_tol=1e-9) else 4
    return f"\\${usd_per_kwh:.{digits}f}"


def change_lines(trace: Trace, vehicle: str, outlook: Outlook) -> list[tuple[int, str]]:
    """Every interval in which its plan was changed, and how, latest first."""
    lines = []
    for last, step in zip(trace.steps, trace.steps[1:], strict=False):
        names = tuple(contract.vehicle for contract in last.after.contracts)
        if vehicle in names and vehicle in step.plan.vehicles:
            before, after = names.index(vehicle), step.plan.vehicles.index(vehicle)
            moves = moves_between(
                (vehicle,),
                last.after.tail_kw[before : before + 1],
                step.plan.power_kw[after : after + 1],
                step.interval,
                trace.scenario.interval_hours,
            )
            moves = tuple(move for move in moves if move.energy_kwh >= TOLD_KWH)
            if moves:
                lines.append((step.interval, _moved(moves, step.interval, outlook)))
    return lines[::-1]


def _moved(moves: Sequence[Move], interval: int, outlook: Outlook) -> str:
    told = [
        f"{move.energy_kwh:.1f}\u00a0kWh from {clock(outlook.times[move.from_interval], outlook)} "
        f"to {clock(outlook.times[move.to_interval], outlook)}"
        for move in moves
    ]
    return f"**{clock(outlook.times[interval], outlook)}:** {'; '.join(told)}"


def counted_line(shown: int, of: int) -> str:
    """How many vehicles are listed."""
    return counted(of, "vehicle") if shown == of else f"{shown:,} of {counted(of, 'vehicle')}"
