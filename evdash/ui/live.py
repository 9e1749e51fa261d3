"""The pieces of the Live page, each a call."""

from collections.abc import Callable

import pandas as pd
import streamlit as st

from evdash.charts.admissions import admissions_alt, admissions_figure, admissions_table
from evdash.charts.load import load_alt, load_table, normalised_figure, units_figure
from evdash.charts.schedule import schedule_alt, schedule_figure, schedule_table
from evdash.charts.style import CONFIG, Figure
from evdash.charts.voltages import voltages_alt, voltages_figure, voltages_table
from evdash.domain.outlook import Outlook
from evdash.metrics.ac import AcPoint
from evdash.metrics.outlook import outlook
from evdash.metrics.totals import totals
from evdash.ui.referee import referee
from evdash.ui.session import Session
from evdash.ui.words import (
    ac_lines,
    clock,
    counted,
    decision_lines,
    decision_title,
    element_name,
    markdown_table,
    money,
    plain,
    story,
)

ROW_PX = 29
AC_PATIENCE_SECONDS = 0.06
"""How long a page waits for the AC power flow of its latest step before it goes on without."""


def view(session: Session) -> Outlook:
    """The horizon as it stands."""
    return session.once("outlook", lambda: outlook(session.run.trace))


def headline(session: Session) -> None:
    """The story in a sentence."""
    trace, ahead = session.run.trace, view(session)
    sums = session.once("totals", lambda: totals(trace))
    with st.container(key="sentence"):
        st.markdown(story(trace, ahead, sums))


def toolbar(session: Session) -> None:
    """The clock; step, run, play, back, reset."""
    trace, ahead = session.run.trace, view(session)
    minutes = trace.scenario.interval_minutes
    with st.container(key="toolbar", horizontal=True, vertical_alignment="center", gap="xsmall"):
        with st.container(key="clock", width=130):
            st.markdown(f"{ahead.clock:%H:%M}")
        st.button(
            f"Step {'1 h' if minutes == 60 else f'{minutes} min'}",
            on_click=session.step,
            key="step",
            type="primary",
            icon=":material/skip_next:",
            disabled=trace.is_over or session.mode == "finishing",
        )
        _modes(session)
        st.button(
            "Back",
            on_click=session.back,
            key="back",
            icon=":material/skip_previous:",
            disabled=not trace.steps,
            help="Undo the last step, and changes made since.",
        )
        st.button(
            "Reset",
            on_click=session.reset,
            key="reset",
            icon=":material/restart_alt:",
            disabled=not trace.steps,
            help="Back to the start of the day, with the settings as they are now.",
        )
        st.caption(
            f"{ahead.clock:%A, %d %B} · {trace.now} of "
            f"{counted(ahead.n_intervals, 'interval')} decided",
            text_alignment="right",
        )


def _modes(session: Session) -> None:
    """Buttons that set a run going, and stop it."""
    over, mode = session.run.trace.is_over, session.mode
    finishing, playing = mode == "finishing", mode == "playing"
    st.button(
        "Stop" if finishing else "Run to end",
        on_click=session.set_mode,
        args=("idle" if finishing else "finishing",),
        key="finish",
        icon=":material/stop:" if finishing else ":material/fast_forward:",
        disabled=over,
    )
    st.button(
        "Pause" if playing else "Play",
        on_click=session.set_mode,
        args=("idle" if playing else "playing",),
        key="play",
        icon=":material/pause:" if playing else ":material/play_arrow:",
        disabled=over or finishing,
    )


def answer(session: Session) -> None:
    """What an edit that was not applied would have done, or what was wrong with it."""
    said = session.run.answer
    if said is None:
        return
    with st.container(key="answer"):
        if said.shortfalls:
            missing = sum(shortfall.missing_kwh for shortfall in said.shortfalls)
            st.error(
                f"**{said.title}.** It would break "
                f"{counted(len(said.shortfalls), 'contract')} already made: at least "
                f"{missing:.1f} kWh would be missing by the promised time. Nothing was changed.",
                icon=":material/block:",
            )
            rows = [{"Vehicle": s.vehicle, "Missing, kWh": s.missing_kwh} for s in said.shortfalls]
            _table(rows, "Vehicles and the energy each would miss")
        else:
            faults = "\n".join(
                f"- {plain(f.place)}: found {plain(f.found)}; {plain(f.allowed)}"
                for f in said.faults
            )
            st.error(f"**{said.title}.**\n{faults}", icon=":material/error:")


def key_figures(session: Session) -> None:
    """The run in numbers with their units."""
    trace, ahead = session.run.trace, view(session)
    sums = session.once("totals", lambda: totals(trace))
    last = trace.steps[-1] if trace.steps else None
    charging = int(last.plan.charging[0]) if last else 0
    power = last.station_kw if last else 0.0
    headroom = ahead.headroom_kw[max(0, trace.now - 1)]
    span = f"in the interval before {clock(ahead.clock, ahead)}" if last else "before the day"
    figures = (
        ("Admitted", f"{sums.admitted:,}", f"of {sums.arrived:,} who asked", "Contracts made."),
        (
            "Parked",
            f"{parked(session):,}",
            "under contract",
            f"Vehicles within their promised window {span}, charging or not.",
        ),
        (
            "Charging",
            f"{charging:,}",
            f"of {counted(trace.scenario.station.chargers, 'charger')}",
            f"Vehicles charging {span}.",
        ),
        (
            "Station load",
            f"{power:,.0f} kW",
            f"room for {headroom:,.0f} kW" if headroom < float("inf") else "no limit",
            f"Mean power {span}, and the most the feeder would have allowed (headroom).",
        ),
        (
            "Delivered",
            f"{sums.energy_delivered_kwh:,.0f} kWh",
            "from the grid",
            "Energy drawn from the grid so far.",
        ),
        (
            "Revenue",
            money(sums.revenue),
            "contracts so far",
            "What all admitted drivers pay, in full, for contracts made so far.",
        ),
        ("Energy cost", money(sums.energy_cost), "energy so far", "Paid for energy drawn so far."),
        ("Profit", money(sums.profit), "revenue less cost", "Revenue less energy cost so far."),
    )
    with st.container(key="figures"):
        for column, (label, value, small, told) in zip(
            st.columns(len(figures), gap="xsmall"), figures, strict=True
        ):
            column.metric(
                label,
                value.replace("\\", ""),
                small,
                delta_color="off",
                delta_arrow="off",
                help=told,
            )


def parked(session: Session) -> int:
    """Vehicles inside their promised window in the interval just executed."""
    trace = session.run.trace
    interval = trace.now - 1
    return sum(
        request.arrival_interval <= interval < request.deadline_interval
        for step in trace.steps
        for request in step.requests
        if request.vehicle in step.plan.admitted
    )


def schedule(session: Session) -> None:
    """Who charges when."""
    trace, ahead = session.run.trace, view(session)
    with st.container(key="schedule"):
        st.markdown("#### Charging schedule", help=SCHEDULE_HELP)
        _chart(
            session,
            "schedule",
            lambda: schedule_figure(trace, ahead),
            schedule_alt(trace, ahead),
        )
        _table_below("schedule", lambda: schedule_table(trace, ahead))


SCHEDULE_HELP = (
    "One row a vehicle under contract. Outlined: from arrival to the promised return. Solid: "
    "charged; hatched: planned; the thicker, the higher the power. At the end: its price option "
    "and how much of what was promised it has."
)


def decision(session: Session) -> None:
    """What the optimiser just decided."""
    trace, ahead = session.run.trace, view(session)
    with st.container(key="decision"):
        if not trace.steps:
            st.markdown("#### What the optimiser decides")
            st.markdown(INTRODUCTION)
            return
        last = trace.steps[-1]
        st.markdown(f"#### {decision_title(last, ahead)}", help=DECISION_HELP)
        for line in decision_lines(last, ahead):
            st.markdown(line)
        if last.requests:
            rows = session.once("requests", lambda: _requests(session))
            _small_table(rows, height=290)
            _table_below("requests", lambda: _reasons(session), "All answers in full")


INTRODUCTION = (
    "Every interval new vehicles ask for a charge and choose a price. The station says **yes** — "
    "a contract: this much energy by that time — or **no**, at once, knowing nothing of who comes "
    "later. Then it plans all contracted charging anew, for the highest profit within what the "
    "feeder and the chargers allow.\n\nPress **Step** to decide the first interval."
)
DECISION_HELP = (
    "The plan is the solution of a mixed-integer linear program. Its cost is compared with a "
    "bound no plan can beat: within 1 cent of it, the plan counts as proven optimal."
)


def _requests(session: Session) -> list[dict[str, object]]:
    ahead, step = view(session), session.run.trace.steps[-1]
    refused = {refusal.vehicle for refusal in step.plan.refused}
    return [
        {
            "Vehicle": request.vehicle,
            "Option": request.option,
            "kWh": round(request.need_kwh, 1),
            "Back by": clock(ahead.times[request.deadline_interval], ahead),
            "Answer": "✗ no" if request.vehicle in refused else "✓ yes",
        }
        for request in step.requests
    ]


def _reasons(session: Session) -> list[dict[str, object]]:
    plan = session.run.trace.steps[-1].plan
    reasons = {refusal.vehicle: refusal.reason for refusal in plan.refused}
    return [
        {"Vehicle": row["Vehicle"], "Why not": reasons.get(str(row["Vehicle"]), "admitted")}
        for row in _requests(session)
    ]


def admissions(session: Session) -> None:
    """Who asked, was admitted, was refused."""
    trace, ahead = session.run.trace, view(session)
    st.markdown("#### Admitted and refused")
    _chart(
        session,
        "admissions",
        lambda: admissions_figure(trace, ahead),
        admissions_alt(trace, ahead),
    )
    _table_below("admissions", lambda: admissions_table(trace, ahead))


def load(session: Session) -> None:
    """Station load against headroom, feeder load and price."""
    ahead = view(session)
    with st.container(horizontal=True, vertical_alignment="center", key="load_head"):
        st.markdown("#### Load and price", help=LOAD_HELP, width="content")
        in_units = st.toggle("in kW and \\$/kWh", key="in_units", persist_state="session")
    draw = units_figure if in_units else normalised_figure
    _chart(session, "load", lambda: draw(ahead), load_alt(ahead), detail=in_units)
    _table_below("load", lambda: load_table(ahead))


LOAD_HELP = (
    "As shares: station load and headroom of the rating nearest to the station, feeder load of "
    "its peak, price of its highest. Headroom: the most the station may draw so that no limit "
    "of the feeder is exceeded."
)


def voltages(session: Session) -> None:
    """Nodal voltages with their limits, and what the AC power flow found."""
    ahead = view(session)
    found = referee.findings(session.run.trace, AC_PATIENCE_SECONDS)
    ac = {interval: finding.voltage_pu for interval, finding in found.items()}
    left, right = st.columns([2, 1], gap="medium")
    with left:
        st.markdown("#### Voltages", help=VOLTAGE_HELP)
        _chart(
            session,
            "voltages",
            lambda: voltages_figure(ahead, ac),
            voltages_alt(ahead),
            detail=len(ac),
        )
        _table_below("voltages", lambda: voltages_table(ahead, ac))
    with right, st.container(key="ac"):
        _ac_words(session, found)
        _limits(session)


VOLTAGE_HELP = (
    "Per unit (pu): as a share of nominal voltage. The optimiser works with a linearised model "
    "of the feeder; the full AC power flow, which knows losses, checks what was executed."
)


def _ac_words(session: Session, found: dict[int, AcPoint]) -> None:
    trace, ahead = session.run.trace, view(session)
    st.markdown("#### Checked by AC power flow", help=VOLTAGE_HELP)
    waiting = len(trace.steps) - len(found)
    if not trace.steps:
        st.markdown("Executed intervals are checked here by the full AC power flow.")
        return
    if waiting:
        st.markdown(f":material/hourglass_top: {counted(waiting, 'interval')} being checked …")
    unsolved = sum(not finding.solved for finding in found.values())
    if unsolved:
        st.markdown(f":red[No AC solution in {counted(unsolved, 'interval')}.]")
    breaches = [breach for t in sorted(found) for breach in found[t].breaches if found[t].solved]
    for line in ac_lines(breaches, trace.scenario, ahead):
        st.markdown(f":red[:material/warning: {line}]")
    if not waiting and not breaches and not unsolved:
        st.markdown(":green[:material/check_circle: Every limit holds in AC, too.]")


def _limits(session: Session) -> None:
    ahead = view(session)
    first = 0 if session.run.trace.is_over else ahead.now
    st.markdown("#### Limits by the hour", help=LIMITS_HELP)
    rows = session.once("limits", lambda: limit_rows(ahead, first))
    _small_table(rows, height=330)


LIMITS_HELP = (
    "Of all limits of the feeder the tightest in each interval, whether reached or not, and the "
    "room it leaves for charging (headroom). Voltages by the linearised model."
)


def limit_rows(ahead: Outlook, first: int) -> list[dict[str, object]]:
    """Headroom and what sets it, by interval, as rows of a table."""
    return [
        {
            "From": clock(ahead.times[t], ahead),
            "Room, kW": round(float(ahead.headroom_kw[t])) if ahead.binding[t] else None,
            "Limited by": element_name(ahead.binding[t]),
        }
        for t in range(first, ahead.n_intervals)
    ]


def _chart(
    session: Session,
    name: str,
    draw: Callable[[], Figure],
    alt: str,
    detail: object = None,
) -> None:
    figure = session.once(f"figure:{name}", draw, detail=detail)
    st.plotly_chart(figure, key=f"chart_{name}", config=CONFIG, alt=alt)


def _table_below(
    name: str, rows: Callable[[], list[dict[str, object]]], label: str = "As a table"
) -> None:
    """Numbers as a table, made only when opened."""
    box = st.expander(label, key=f"table_{name}", type="compact", on_change="rerun")
    if box.open:
        with box:
            _table(rows(), f"The numbers of the {name} chart")


def _table(rows: list[dict[str, object]], alt: str) -> None:
    st.dataframe(pd.DataFrame(rows), hide_index=True, alt=alt)


def _small_table(rows: list[dict[str, object]], height: int) -> None:
    """A table that changes with every step: text costs a browser a tenth of a data grid."""
    fits = ROW_PX * (len(rows) + 1) <= height
    with st.container(height="content" if fits else height, border=False):
        st.markdown(markdown_table(rows))
