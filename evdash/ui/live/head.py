"""The head of the Live page: the story, what came of the last edit, the key figures."""

import streamlit as st

from evdash.metrics.ledger import broken_promises, ledger
from evdash.metrics.service import totals
from evdash.ui.parts import table, view
from evdash.ui.session import Session
from evdash.ui.story import story
from evdash.ui.words import clock, counted, money, plain

BROKEN = "Broken"


def headline(session: Session) -> None:
    """The story in a sentence."""
    trace, ahead = session.run.trace, view(session)
    sums = session.once("totals", lambda: totals(trace))
    with st.container(key="sentence"):
        st.markdown(session.once("story", lambda: story(trace, ahead, sums)))


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
            table(rows, "Vehicles and the energy each would miss")
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
    chargers = (last.inputs.scenario if last else trace.scenario).station.chargers
    headroom = ahead.headroom_kw[max(0, trace.now - 1)]
    span = f"in the interval before {clock(ahead.clock, ahead)}" if last else "before the day"
    broken = session.once("broken", lambda: broken_promises(ledger(trace)))
    missing_kwh = sum(entry.short_kwh for entry in broken)
    figures = (
        ("Admitted", f"{sums.admitted:,}", f"of {sums.arrived:,} asked", "Contracts made."),
        (
            BROKEN,
            f"{len(broken):,}",
            f"{missing_kwh:,.1f} kWh" if broken else f"of {sums.admitted:,} promises",
            "Promises not kept, or sure not to be as things stand, from the moment that is known; "
            "and the energy missing.",
        ),
        (
            "Parked",
            f"{parked(session):,}",
            "under contract",
            f"Vehicles within their promised window {span}, charging or not.",
        ),
        (
            "Charging",
            f"{charging:,}",
            f"of {counted(chargers, 'charger')}",
            f"Vehicles charging {span}.",
        ),
        (
            "Station load",
            f"{power:,.0f} kW",
            f"of {headroom:,.0f} kW" if headroom < float("inf") else "no limit",
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
            "so far",
            "What all admitted drivers pay for contracts made so far: for the whole contract, or, "
            "where it is broken or cut short, for what is delivered.",
        ),
        ("Energy cost", money(sums.energy_cost), "so far", "Paid for energy drawn so far."),
        ("Profit", money(sums.profit), "so far", "Revenue less energy cost so far."),
    )
    with st.container(key="figures", horizontal=True, gap="xsmall"):
        for label, value, small, told in figures:
            st.metric(
                label,
                value.replace("\\", ""),
                small,
                delta_color="inverse" if label == BROKEN and broken else "off",
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
