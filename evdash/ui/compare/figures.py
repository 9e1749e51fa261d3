"""Key figures of the runs side by side, and how far each is from the one compared against."""

from collections.abc import Callable
from dataclasses import dataclass

import streamlit as st

from evdash.metrics.key_figures import KeyFigures, key_figures
from evdash.metrics.outlook import outlook
from evdash.ui.apart import apart
from evdash.ui.compare.pins import Held
from evdash.ui.referee import referee
from evdash.ui.words import counted, money, plain

POLL_SECONDS = 0.5
LONGEST_HEAD = 24


@dataclass(frozen=True, slots=True)
class Figure:
    """One figure by which runs are compared: label with its unit, value, and its form."""

    label: str
    value: Callable[[KeyFigures], float | None]
    form: str = ",.0f"
    dollars: bool = False


FIGURES = (
    Figure("Asked, vehicles", lambda k: k.day.arrived),
    Figure("Admitted, vehicles", lambda k: k.day.admitted),
    Figure("Refused, vehicles", lambda k: k.day.refused),
    Figure("Broken promises", lambda k: k.broken),
    Figure("Energy delivered, kWh", lambda k: k.day.energy_delivered_kwh, ",.1f"),
    Figure("Revenue", lambda k: k.day.revenue, ",.2f", dollars=True),
    Figure("Energy cost", lambda k: k.day.energy_cost, ",.2f", dollars=True),
    Figure("Profit", lambda k: k.day.profit, ",.2f", dollars=True),
    Figure("Peak station load, kW", lambda k: k.day.peak_station_kw, ",.1f"),
    Figure("Lowest voltage, linearised, pu", lambda k: k.lowest_voltage_pu, ".4f"),
    Figure("Lowest voltage, AC, pu", lambda k: k.lowest_ac_pu, ".4f"),
    Figure("Charging beyond limits in AC, intervals", lambda k: k.ac_breached),
    Figure("Feeder itself beyond limits in AC, intervals", lambda k: k.ac_breached_by_feeder),
    Figure("Solving, all intervals, s", lambda k: k.solve_seconds, ",.2f"),
    Figure("Solving, slowest interval, s", lambda k: k.worst_solve_seconds, ",.2f"),
)


def figures(held: list[Held], against: Held) -> None:
    """A row for each figure, a column for each run, and its difference to `against`."""
    ac = {run.name: referee.findings(run.common) for run in held}
    found = {run.name: key_figures(run.common, outlook(run.common), ac[run.name]) for run in held}
    others = [run for run in held if run is not against]
    for run in others:
        st.markdown(in_words(found[against.name], found[run.name], run.name, against.name))
    with st.container(key="compare_figures"):
        st.markdown(_table(found, against.name, [run.name for run in others]))
    waiting = sum(run.common.now - found[run.name].ac_known for run in held)
    if waiting:
        st.caption(
            f":material/hourglass_top: {counted(waiting, 'interval')} still being checked by AC "
            "power flow; the three AC rows are of those known so far."
        )
    for run in held:
        unchecked = found[run.name].ac_unchecked
        if unchecked:
            st.caption(
                f":red[:material/warning: **{plain(run.name)}**: {counted(unchecked, 'interval')} "
                "could not be checked by AC power flow; the three AC rows leave them out.]"
            )
    apart(_look_again, POLL_SECONDS if waiting else None)(held, waiting)


def _look_again(held: list[Held], waiting: int) -> None:
    """Draw the page anew once AC results that were missing have come."""
    missing = sum(run.common.now - len(referee.findings(run.common)) for run in held)
    if missing == 0 < waiting:
        st.rerun()


def _table(found: dict[str, KeyFigures], against: str, others: list[str]) -> str:
    heads = [against, *(head for name in others for head in (name, "difference"))]
    lines = [
        "| | " + " | ".join(plain(short(head)) for head in heads) + " |",
        "|:--|" + "--:|" * len(heads),
    ]
    for figure in FIGURES:
        base = figure.value(found[against])
        cells = [told(figure, base)]
        for name in others:
            value = figure.value(found[name])
            cells += [told(figure, value), difference(figure, base, value)]
        lines.append(f"| {figure.label} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def short(name: str) -> str:
    """A run's name for the head of a column."""
    return name if len(name) <= LONGEST_HEAD else f"{name[: LONGEST_HEAD - 1]}…"


def told(figure: Figure, value: float | None) -> str:
    """A value with its sign and currency; a dash where there is none."""
    if value is None:
        return "–"
    sign = "−" if round(value, 6) < 0 else ""
    return f"{sign}{'&#36;' if figure.dollars else ''}{abs(value):{figure.form}}"


def difference(figure: Figure, base: float | None, value: float | None) -> str:
    """How far a value is from the one compared against, with its sign: of both as they are told."""
    if base is None or value is None:
        return "–"
    apart = _as_told(figure, value) - _as_told(figure, base)
    if not apart:
        return "="
    sign = "+" if apart > 0 else "−"
    return f"{sign}{'&#36;' if figure.dollars else ''}{abs(apart):{figure.form}}"


def _as_told(figure: Figure, value: float) -> float:
    return float(f"{value:{figure.form}}".replace(",", ""))


def in_words(base: KeyFigures, other: KeyFigures, name: str, against: str) -> str:
    """What sets a run apart from the one compared against, in one sentence."""
    admitted = other.day.admitted - base.day.admitted
    profit = other.day.profit - base.day.profit
    peak = other.day.peak_station_kw - base.day.peak_station_kw
    parts = [
        f"{abs(admitted):,} {'more' if admitted > 0 else 'fewer'} admitted" if admitted else "",
        f"profit {money(abs(profit))} {_side(profit)}" if round(profit, 2) else "",
        f"peak load {abs(peak):,.1f} kW {_side(peak)}" if round(peak, 1) else "",
    ]
    said = ", ".join(part for part in parts if part) or "no difference in admissions or money"
    return f"**{plain(name)}** against **{plain(against)}**: {said}.{_beyond(base, other)}"


def _beyond(base: KeyFigures, other: KeyFigures) -> str:
    """What money was earned beyond: promises and limits, so that none is told as if within."""
    told = []
    if base.broken or other.broken:
        told.append(f"breaks {counted(other.broken, 'promise')}, against {base.broken:,}")
    if base.ac_breached or other.ac_breached:
        told.append(
            f"charges beyond limits in AC in {counted(other.ac_breached, 'interval')}, against "
            f"{base.ac_breached:,}"
        )
    return f" It {' and '.join(told)}." if told else ""


def _side(difference: float) -> str:
    return "higher" if difference > 0 else "lower"
