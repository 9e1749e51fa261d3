"""The equations of the station, filled in: (8), (9) and what is minimised."""

from evdash.scheduling import equations
from evdash.ui.model.card import Card, Filled, Numbers
from evdash.ui.model.tex import number, total, usd
from evdash.ui.words import counted, element_words, money


def station_power(n: Numbers) -> Filled:
    """(8)."""
    s = n.station
    powers = sorted(s.power_kw.values(), reverse=True)
    tex = rf"p^{{EV}} = {total(powers)} = {number(s.total_kw)}\ \text{{kW}}"
    if s.headroom_kw < float("inf"):
        where = element_words(s.binding, n.step.inputs.scenario)
        room = f"The feeder leaves {s.headroom_kw:,.1f} kW for it, limited by {where}."
    else:
        room = "The feeder sets no limit to it."
    return tex, f"{counted(len(powers), 'vehicle')} together draw {s.total_kw:,.1f} kW. {room}"


def charger_count(n: Numbers) -> Filled:
    """(9)."""
    s = n.station
    running = len(s.power_kw)
    free = s.chargers - running
    said = "all chargers are taken" if free == 0 else f"{counted(free, 'charger')} free"
    return rf"{running} \le {s.chargers}", f"{running} charging at {n.span}, {said}."


def objective(n: Numbers) -> Filled:
    """(P1)."""
    s = n.station
    worth = s.energy_cost - s.new_revenue
    tex = rf"{usd(s.energy_cost)} - {usd(s.new_revenue)} = {usd(worth)}"
    proven = f" No plan at all can get below {money(s.bound)}." if s.bound is not None else ""
    return tex, (
        f"The energy of the whole plan costs {money(s.energy_cost)}, the newcomers admitted now "
        f"pay {money(s.new_revenue)}.{proven} What earlier contracts pay is settled and left out."
    )


STATION = (
    Card(
        "(8)",
        "The station is the sum of its vehicles",
        r"p^{EV}_t = \sum_n P_{nt}",
        station_power,
        equations.station_power,
    ),
    Card(
        "(9)",
        "No more at once than chargers",
        r"\sum_n D_{nt} \le \overline{N}",
        charger_count,
        equations.charger_count,
    ),
    Card(
        "(P1)",
        "What is minimised",
        r"\min\ \sum_{n,t} c_t P_{nt}\,\Delta t - \sum_{n\ "
        r"\text{new}} C_n s_n u_n",
        objective,
        equations.profit,
    ),
)
