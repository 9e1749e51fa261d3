"""From a request to a contract, and from hour to hour, filled in: s, a and (10)."""

from evdash.horizon.advance import advance
from evdash.horizon.requests import need_kwh, promised_intervals
from evdash.ui.model.card import NOBODY, Card, Filled, Numbers
from evdash.ui.model.tex import lines, number
from evdash.ui.words import counted, plain


def energy_need(n: Numbers) -> Filled:
    """s_n."""
    v = n.vehicle
    if v is None:
        return NOBODY
    r, efficiency = v.request, n.step.inputs.scenario.station.efficiency
    tex = (
        rf"s = \frac{{({r.soc_out:.3g} - {r.soc_in:.3g}) \cdot {number(r.battery_kwh)}}}"
        rf"{{{efficiency:g}}} = {number(r.need_kwh)}\ \text{{kWh}}"
    )
    return tex, (
        f"{plain(r.vehicle)} came with {100 * r.soc_in:.3g} % and wants {100 * r.soc_out:.3g} % "
        f"of {r.battery_kwh:g} kWh; charging losses included, the grid must give "
        f"{r.need_kwh:,.1f} kWh."
    )


def return_time(n: Numbers) -> Filled:
    """a_n."""
    v = n.vehicle
    if v is None:
        return NOBODY
    r, scenario = v.request, n.step.inputs.scenario
    option = scenario.options_by_name.get(r.option)
    average = min(option.average_kw if option else r.max_kw, r.max_kw)
    whole = promised_intervals(r.need_kwh, average, r.max_kw, v.interval_hours)
    tex = (
        rf"a = \left\lceil \frac{{{number(r.need_kwh)}}}"
        rf"{{{number(average)} \cdot {v.interval_hours:g}}} \right\rceil = {whole}"
    )
    back = f"{scenario.time_of(r.deadline_interval):%H:%M}"
    if min(r.arrival_interval + whole, scenario.intervals) != r.deadline_interval:
        return "", f"{plain(r.vehicle)} got its terms under other settings: back by {back}."
    cut = r.arrival_interval + whole > scenario.intervals
    end = ", cut short by the end of the horizon" if cut else ""
    return tex, (
        f"Option {plain(r.option)} promises {average:g} kW on average, so the charge may take "
        f"{counted(whole, 'interval')}: back by {back}{end}."
    )


def next_interval(n: Numbers) -> Filled:
    """(10)."""
    v = n.vehicle
    if v is None or not v.admitted:
        return "", "Without a contract nothing is carried on to the next interval."
    left = v.owed_kwh - v.delivered_now_kwh
    tex = lines(
        rf"s \leftarrow {number(v.owed_kwh)} - {number(v.delivered_now_kwh)} = {number(left)}\ "
        r"\text{kWh}",
        rf"a \leftarrow {v.intervals_left} - 1 = {v.intervals_left - 1}",
    )
    said = f"still owed {left:,.1f} kWh" if left > 0.05 else "fully charged"
    return tex, f"After {n.span} {plain(v.request.vehicle)} is {said}."


CLOCK = (
    Card(
        "(sₙ)",
        "How much energy a vehicle needs",
        r"s_n = \frac{(SOC_{out} - SOC_{in}) \cdot "
        r"Bcap_n}{\eta}",
        energy_need,
        need_kwh,
    ),
    Card(
        "(aₙ)",
        "How long it may take",
        r"a_n = \left\lceil \frac{s_n}{P_{C_j}\,\Delta t} "
        r"\right\rceil",
        return_time,
        promised_intervals,
    ),
    Card(
        "(10)",
        "On to the next interval",
        r"s_n \leftarrow s_n - P_{n1}\,\Delta t,\qquad "
        r"a_n \leftarrow a_n - 1",
        next_interval,
        advance,
    ),
)
