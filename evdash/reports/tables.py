"""The tables of a report: rows of plain values, headers with units, for HTML and cells alike."""

from collections.abc import Callable, Sequence

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.words import depth_words, element_name
from evdash.explain.words import Clock
from evdash.grid.radial import radial_feeder
from evdash.metrics.ac_day import AcDay
from evdash.metrics.ageing import Ageing
from evdash.metrics.declared import figures_of
from evdash.metrics.durations import Beyond, above, below
from evdash.metrics.ledger import LedgerEntry, ledger
from evdash.metrics.outlook import spans_in_force
from evdash.metrics.records import refused_by_reason, vehicle_records
from evdash.metrics.service import Service, service
from evdash.metrics.verdict import violations
from evdash.reports.account import Account
from evdash.reports.words import CAUSES, violation_words

Row = dict[str, object]
VOLTAGE_STEP_PU = 0.01
ANSI_LOW_PU, ANSI_HIGH_PU = 0.95, 1.05
"""Service voltage by ANSI C84.1, range A."""
LOADING_PERCENT = (80.0, 90.0, 100.0, 110.0, 120.0, 150.0)
ALWAYS_PERCENT = (80.0, 100.0)
LEDGER_WORDS = {
    "open": "under way",
    "kept": "kept",
    "short": "short",
    "released": "cut short by its driver",
}


def service_of(account: Account) -> Service:
    """How well the day served, in the figures runs are compared by."""
    verdict = account.verdict
    return service(account.trace, AcDay(verdict.flow, verdict.ac))


def figure_rows(account: Account) -> list[Row]:
    """Those figures that there are, each with its unit and meaning."""
    found = service_of(account)
    return [
        {
            "Figure": figure.label,
            "Value": figure.told(getattr(found, figure.name)),
            "Unit": figure.unit,
            "Meaning": figure.meaning,
        }
        for figure in figures_of(Service)
        if getattr(found, figure.name) is not None
    ]


def option_rows(account: Account) -> list[Row]:
    """How each price option fared."""
    records = vehicle_records(account.trace)
    rows = []
    for option in account.scenario.option:
        mine = [record for record in records if record.request.option == option.name]
        admitted = [record for record in mine if record.status != "refused"]
        share = 100 * len(admitted) / len(mine) if mine else None
        rows.append(
            {
                "Option": option.name,
                "Price, $/kWh": option.price_per_kwh,
                "Average power promised, kW": option.average_kw,
                "Asked": len(mine),
                "Admitted": len(admitted),
                "Accepted, %": None if share is None else round(share, 1),
                "Delivered, kWh": round(sum(record.delivered_kwh for record in mine), 1),
                "Revenue, $": round(sum(record.revenue for record in mine), 2),
            }
        )
    return rows


def reason_rows(account: Account) -> list[Row]:
    """Refusals by reason."""
    return [
        {
            "Reason": reason,
            "Vehicles": len(records),
            "Energy refused, kWh": round(sum(r.request.need_kwh for r in records), 1),
            "For example": f"{records[0].vehicle}: {records[0].why_not}",
        }
        for reason, records in refused_by_reason(vehicle_records(account.trace)).items()
    ]


def decision_rows(account: Account) -> list[Row]:
    """Everyone who asked: what for, what was answered, and why."""
    clock = Clock(account.scenario, 0)
    return [
        {
            "Vehicle": record.vehicle,
            "Option": record.request.option,
            "Came": f"{record.request.arrival:%H:%M}",
            "Asked for, kWh": round(record.request.need_kwh, 2),
            "Back by": clock.at(record.request.deadline_interval),
            "Answer": "refused" if record.status == "refused" else "admitted",
            "Delivered, kWh": round(record.delivered_kwh, 2),
            "Pays, $": round(record.revenue, 2),
            "Why refused": record.why_not,
        }
        for record in vehicle_records(account.trace)
    ]


def ledger_rows(account: Account) -> list[Row]:
    """Every promise made and what became of it."""
    return [_ledger_row(entry, Clock(account.scenario, 0)) for entry in ledger(account.trace)]


def _ledger_row(entry: LedgerEntry, clock: Clock) -> Row:
    since = entry.since_interval
    return {
        "Vehicle": entry.vehicle,
        "Option": entry.option,
        "Promised, kWh": round(entry.promised_kwh, 2),
        "By": clock.at(entry.promised_by_interval),
        "Last agreed, kWh": round(entry.revised_kwh, 2),
        "By then": clock.at(entry.revised_by_interval),
        "Delivered, kWh": round(entry.delivered_kwh, 2),
        "Short, kWh": round(entry.short_kwh, 2),
        "Became": LEDGER_WORDS[entry.status],
        "Known since": "" if since is None else clock.at(since),
        "Cause": entry.cause,
    }


def violation_rows(account: Account) -> list[Row]:
    """Limits exceeded by element and cause in either model: depth, duration and times."""
    scenario, verdict = account.scenario, account.verdict
    clock, hours = Clock(scenario, 0), scenario.interval_hours
    models: Sequence[tuple[str, tuple[Breach, ...]]] = (
        ("linearised", verdict.linear),
        ("AC", verdict.ac),
    )
    return [
        {
            "Limit": element_name(found.element),
            "Model": model,
            "Cause": CAUSES[found.cause],
            "Beyond by": depth_words(found.depth, found.unit),
            "Without charging": (
                depth_words(found.base_depth, found.unit) if found.base_depth > 0 else "held"
            ),
            "For, h": round(hours * len(found.intervals), 2),
            "Worst from": clock.at(found.worst),
            "When": violation_words(found, scenario),
        }
        for model, breaches in models
        for found in violations(breaches)
    ]


def voltage_thresholds(account: Account) -> tuple[list[float], list[float]]:
    """(below, above), pu: the limits and a step on either side of them, and ANSI's range A."""
    low, high = account.outlook.voltage_min_pu, account.outlook.voltage_max_pu
    steps = VOLTAGE_STEP_PU * np.arange(-2, 2)
    below_pu = {round(float(low + step), 6) for step in steps} | {ANSI_LOW_PU}
    above_pu = {round(float(high - step), 6) for step in steps} | {ANSI_HIGH_PU}
    return sorted(below_pu, reverse=True), sorted(above_pu)


def voltage_rows(account: Account) -> list[Row]:
    """How long and how far voltages were beyond thresholds, by AC, without and with charging."""
    low, high = account.outlook.voltage_min_pu, account.outlook.voltage_max_pu
    below_pu, above_pu = voltage_thresholds(account)
    told = {ANSI_LOW_PU: "ANSI C84.1 range A", ANSI_HIGH_PU: "ANSI C84.1 range A"}
    told_low, told_high = told | {low: "lowest allowed"}, told | {high: "highest allowed"}
    rows = []
    for side, find, thresholds, names in (
        ("below", below, below_pu, told_low),
        ("above", above, above_pu, told_high),
    ):
        for threshold in thresholds:
            without, with_it = _both(account, find, threshold)
            if without.hours or with_it.hours or threshold in names:
                name = f" ({names[threshold]})" if threshold in names else ""
                rows.append(
                    {"Voltage": f"{side} {threshold:g} pu{name}"}
                    | _beyond_cells(account, without, with_it, "Node, pu")
                )
    return rows


def _both(account: Account, find: Callable[..., Beyond], threshold: float) -> tuple[Beyond, Beyond]:
    verdict, hours = account.verdict, account.scenario.interval_hours
    without, with_it = (
        find(flow.voltage_pu, threshold, flow.nodes, hours) for flow in (verdict.base, verdict.flow)
    )
    return without, with_it


def loading_percent(account: Account) -> tuple[tuple[str, ...], Floats, Floats]:
    """Rated lines, and their AC loading without and with charging, % of the rating then in force.

    Shapes (intervals, lines).
    """
    verdict = account.verdict
    rating = np.empty_like(verdict.flow.line_kva)
    for inputs, span in spans_in_force(account.trace):
        rating[span] = radial_feeder(inputs.scenario).line_rating_kva
    rated = np.flatnonzero(np.isfinite(rating).all(axis=0) & (rating > 0).all(axis=0))
    names = tuple(verdict.flow.lines[line].name for line in rated)
    loads = [
        100 * flow.line_kva[:, rated] / rating[:, rated] for flow in (verdict.base, verdict.flow)
    ]
    return names, loads[0], loads[1]


def loading_rows(account: Account) -> list[Row]:
    """How long and how far lines and transformers were loaded beyond shares of their ratings."""
    names, base, loaded = loading_percent(account)
    hours = account.scenario.interval_hours
    rows = []
    for threshold in LOADING_PERCENT if names else ():
        without, with_it = (above(load, threshold, names, hours) for load in (base, loaded))
        if without.hours or with_it.hours or threshold in ALWAYS_PERCENT:
            rows.append(
                {"Loading": f"above {threshold:g} %" + (" (rating)" if threshold == 100 else "")}
                | _beyond_cells(account, without, with_it, "Line, % points")
            )
    return rows


def _beyond_cells(account: Account, without: Beyond, with_it: Beyond, of: str) -> Row:
    """Both cases side by side; `of` names what is counted and the unit of depth."""
    kind, unit = of.split(", ")
    digits = 5 if unit == "pu" else 1
    clock = Clock(account.scenario, 0)
    at = "" if with_it.interval is None else f"{with_it.element}, from {clock.at(with_it.interval)}"
    return {
        "Without charging, h": round(without.hours, 2),
        f"Deepest without, {unit}": round(without.depth, digits),
        "With charging, h": round(with_it.hours, 2),
        f"{kind}-hours": round(with_it.element_hours, 2),
        "Longest at one, h": round(with_it.longest_hours, 2),
        f"Deepest, {unit}": round(with_it.depth, digits),
        "Where and when": at,
    }


def node_rows(account: Account) -> list[Row]:
    """Every node's lowest voltage by AC, and how long it was below the limit."""
    verdict, low = account.verdict, account.outlook.voltage_min_pu
    hours, clock = account.scenario.interval_hours, Clock(account.scenario, 0)
    rows = []
    for i, node in enumerate(verdict.flow.nodes):
        base, loaded = verdict.base.voltage_pu[:, [i]], verdict.flow.voltage_pu[:, [i]]
        if not np.isfinite(loaded).any() or not np.isfinite(base).any():
            continue
        rows.append(
            {
                "Node": node,
                "Lowest without charging, pu": round(float(np.nanmin(base)), 5),
                "Lowest, pu": round(float(np.nanmin(loaded)), 5),
                "from": clock.at(int(np.nanargmin(loaded))),
                "Below limit without, h": round(below(base, low, (node,), hours).hours, 2),
                "Below limit, h": round(below(loaded, low, (node,), hours).hours, 2),
            }
        )
    return sorted(rows, key=lambda row: float(str(row["Lowest, pu"])))


def line_rows(account: Account) -> list[Row]:
    """Every rated line's highest loading by AC, and how long it was above 80 and 100 %."""
    names, base, loaded = loading_percent(account)
    hours, clock = account.scenario.interval_hours, Clock(account.scenario, 0)
    rows = []
    for i, name in enumerate(names):
        column = loaded[:, [i]]
        if not np.isfinite(column).any() or not np.isfinite(base[:, i]).any():
            continue
        rows.append(
            {
                "Line or transformer": name,
                "Highest without charging, %": round(float(np.nanmax(base[:, i])), 1),
                "Highest, %": round(float(np.nanmax(column)), 1),
                "from": clock.at(int(np.nanargmax(column))),
                "Above 80 %, h": round(above(column, 80.0, (name,), hours).hours, 2),
                "Above 100 %, h": round(above(column, 100.0, (name,), hours).hours, 2),
            }
        )
    return sorted(rows, key=lambda row: -float(str(row["Highest, %"])))


def ageing_rows(account: Account) -> list[Row]:
    """What the day costs the transformer, without and with charging."""
    if account.aged is None:
        return []
    cases: Sequence[tuple[str, Ageing]] = (
        ("Without charging", account.aged.without_station),
        ("With charging", account.aged.with_station),
    )
    return [
        {
            "": name,
            "Highest hot spot, °C": round(found.highest_c, 1),
            "Ageing, h of life per h": round(found.equivalent_factor, 4),
            "Life lost, h": round(found.life_lost_hours, 3),
            "Life lost, % of normal": round(found.life_lost_percent, 5),
        }
        for name, found in cases
    ]


def thermal_rows(account: Account) -> list[Row]:
    """Everything the ageing assumes of the transformer."""
    if account.aged is None:
        return []
    thermal = account.aged.thermal
    told = (
        ("Line that stands for the transformer", account.aged.name, ""),
        ("Rated power", account.aged.rating_kva, "kVA"),
        ("Ambient temperature, all day", thermal.ambient_c, "°C"),
        ("Top oil over ambient at rated load", thermal.top_oil_rise_k, "K"),
        ("Hot spot over top oil at rated load", thermal.hot_spot_rise_k, "K"),
        ("Load loss over no-load loss at rated load, R", thermal.loss_ratio, ""),
        ("Oil exponent, n", thermal.oil_exponent, ""),
        ("Winding exponent, m", thermal.winding_exponent, ""),
        ("Oil time constant at rated load", thermal.oil_hours, "h"),
        ("Winding time constant", thermal.winding_hours, "h"),
        ("Normal insulation life", thermal.life_hours, "h"),
    )
    return [{"Assumed": name, "Value": value, "Unit": unit} for name, value, unit in told]
