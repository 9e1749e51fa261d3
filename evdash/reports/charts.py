"""The charts of a report, each with its sentence, its alternative text and its table."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.charts.ac_gap import ac_gap_alt, ac_gap_figure, ac_gap_table
from evdash.charts.admissions import admissions_alt, admissions_figure, admissions_table
from evdash.charts.feeder import feeder_figure
from evdash.charts.feeder_layout import layout_of
from evdash.charts.feeder_moment import Moment, feeder_alt, feeder_table, lines_table
from evdash.charts.headroom import headroom_alt, headroom_figure, headroom_table
from evdash.charts.hot_spot import hot_spot_alt, hot_spot_figure, hot_spot_table
from evdash.charts.load import load_alt, load_table, units_figure
from evdash.charts.schedule import GANTT_MOST, schedule_alt, schedule_figure, schedule_table
from evdash.charts.standalone import of_finished_day
from evdash.charts.style import Figure, spans
from evdash.charts.voltages import voltages_alt, voltages_figure, voltages_table
from evdash.domain.breach import Breach
from evdash.metrics.ac import AcPoint
from evdash.metrics.feeder import flows, gaps
from evdash.metrics.service import totals
from evdash.reports.account import Account
from evdash.reports.tables import Row

AS_TABLE = "As a table"
AS_BARS = (
    "A row a vehicle under contract. Outlined: from its arrival to its promised return. Solid: "
    "charged, the thicker, the higher the power. At the end: how much of the promise it got."
)
AS_MAP = (
    "A row a vehicle under contract. Pale: from its arrival to its promised return. Coloured: the "
    "power it was charged with."
)


@dataclass(frozen=True, slots=True)
class Chart:
    """A figure under a title, `told` how to read it, `alt` what it shows in a sentence.

    `tables` holds its numbers by caption; a wide figure is set smaller on paper.
    """

    name: str
    title: str
    told: str
    figure: Figure
    alt: str
    tables: Mapping[str, Sequence[Row]]
    is_wide: bool = False


def schedule_chart(account: Account) -> Chart:
    """Who charges when."""
    trace, ahead = account.trace, account.outlook
    return Chart(
        "schedule",
        "Charging schedule",
        AS_BARS if totals(trace).admitted <= GANTT_MOST else AS_MAP,
        of_finished_day(schedule_figure(trace, ahead), ahead),
        schedule_alt(trace, ahead),
        {AS_TABLE: schedule_table(trace, ahead)},
    )


def admissions_chart(account: Account) -> Chart:
    """Who asked, was admitted, was refused."""
    trace, ahead = account.trace, account.outlook
    return Chart(
        "admissions",
        "Admitted and refused",
        "Vehicles by the interval from which on they could charge.",
        of_finished_day(admissions_figure(trace, ahead), ahead),
        admissions_alt(trace, ahead),
        {AS_TABLE: admissions_table(trace, ahead)},
    )


def load_chart(account: Account) -> Chart:
    """Station load, headroom, feeder load and price."""
    ahead = account.outlook
    return Chart(
        "load",
        "Load and price",
        "Headroom: the most the station may draw so that no limit of the feeder is exceeded.",
        of_finished_day(units_figure(ahead), ahead),
        load_alt(ahead),
        {AS_TABLE: load_table(ahead)},
    )


def headroom_chart(account: Account) -> Chart:
    """Room for charging and what limits it."""
    ahead = account.outlook
    return Chart(
        "headroom",
        "Room for charging, and what limits it",
        "The look of a bar names the element that is reached first.",
        of_finished_day(headroom_figure(ahead), ahead),
        headroom_alt(ahead),
        {AS_TABLE: headroom_table(ahead)},
    )


def voltages_chart(account: Account) -> Chart:
    """Voltages of all nodes."""
    ahead, ac = account.outlook, _ac_voltages(account)
    return Chart(
        "voltages",
        "Voltages",
        "Above: the lowest and the highest node, linearised, and the lowest by AC power flow. "
        "Below: every node, linearised; crosses are outside limits there, rings in AC.",
        of_finished_day(voltages_figure(ahead, ac), ahead),
        voltages_alt(ahead),
        {AS_TABLE: voltages_table(ahead, ac)},
    )


def gap_chart(account: Account) -> Chart:
    """Linearised against AC voltages."""
    ahead = account.outlook
    found = gaps(ahead, _ac_voltages(account))
    return Chart(
        "gap",
        "Linearised against AC",
        "The linearised model leaves losses out; AC power flow (pandapower) is the judge.",
        of_finished_day(ac_gap_figure(ahead, found), ahead),
        ac_gap_alt(ahead, found),
        {AS_TABLE: ac_gap_table(ahead, found)},
    )


def feeder_chart(account: Account) -> Chart:
    """The feeder in the interval in which the station draws most."""
    ahead, verdict = account.outlook, account.verdict
    t = int(np.argmax(ahead.station_kw))
    moment = Moment(
        scenario=account.trace.inputs_at(t).scenario,
        outlook=ahead,
        flows=flows(account.trace, ahead),
        layout=layout_of(account.scenario),
        interval=t,
        linear=_at(verdict.linear, t),
        ac=AcPoint(verdict.flow.voltage_pu[t], verdict.flow.line_kva[t], _at(verdict.ac, t)),
    )
    return Chart(
        "feeder",
        f"The feeder when the station draws most, {spans(ahead)[t]}",
        "Square: the source; diamond: the station. Lines: the wider, the nearer to their rating. "
        "The halo marks the tightest limit. Linearised; what AC power flow finds over a rating or "
        "outside limits (rings) is told as well.",
        feeder_figure(moment),
        feeder_alt(moment),
        {"Its nodes": feeder_table(moment), "Its lines": lines_table(moment)},
        is_wide=True,
    )


def hot_spot_chart(account: Account) -> Chart | None:
    """The transformer's hot spot; None without a transformer."""
    aged = account.aged
    if aged is None:
        return None
    parts = account.outlook, aged.without_station, aged.with_station
    return Chart(
        "hot_spot",
        "The transformer's hot spot",
        "Worked out by the minute from the AC load of each interval.",
        of_finished_day(hot_spot_figure(*parts), account.outlook),
        hot_spot_alt(*parts),
        {AS_TABLE: hot_spot_table(*parts)},
    )


def _at(breaches: Iterable[Breach], interval: int) -> tuple[Breach, ...]:
    return tuple(breach for breach in breaches if breach.interval == interval)


def _ac_voltages(account: Account) -> dict[int, np.ndarray]:
    return dict(enumerate(account.verdict.flow.voltage_pu))
