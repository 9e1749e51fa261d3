"""What the paper states, beside what this run shows; and what of the original nobody can know."""

from datetime import time

import streamlit as st

from evdash.charts.admissions import admissions_alt, admissions_figure, admissions_table
from evdash.charts.completion import completion_alt, completion_figure, completion_table
from evdash.charts.load import load_alt, load_table, normalised_figure
from evdash.metrics.statements import (
    admitted_within,
    intermittent,
    price_paid,
    station_share_at_peak,
)
from evdash.ui.parts import chart, table_below, view
from evdash.ui.session import Session
from evdash.ui.words import counted

OFF_PEAK = ((time(0), time(6)), (time(8), time(14)))
"""Off-peak hours of section II-B from midnight on: to 6 am, and from 8 am to 2 pm."""
PEAK = ((time(18), time(20)),)
"""Peak hours of section II-B: 6 to 8 pm."""
NOT_YET = "Run the day to its end, and what it shows is told here."

UNKNOWN = """\
The paper leaves open, and no other source tells:

- **who arrives**: how many vehicles, when, with which batteries and states of charge; it says
  "random arrival", without distribution or number;
- **prices**: neither the energy prices of the day nor what C1 and C2 cost, nor the average rates
  behind them;
- **the station**: how many chargers it has, and the rating of the transformer its load is
  normalised with;
- **the feeder**: its single-phase reduction of the three-phase IEEE 13-node feeder, the voltage of
  the substation, and which node its "node 5" is. Numbered breadth-first from the substation that
  is node 634, behind the 500 kVA transformer, and so it is taken here;
- **the load profile**: 300 houses of Pecan Street's data, which may not be passed on; here a
  utility's residential profile stands in for it;
- **what was timed**: "the total time for solving P1" of "100 instances" is read here as all the
  intervals of a day together. The version of the solver and its gap are not given;
- **its figures**: only what the text says of them is known here, not their images. Figures 2 to 4
  are drawn in their form, with this run's numbers, and are not copies.
"""
ASSUMPTIONS = """\
**What the paper assumes, and evdash with it**

- Prices, loads and generation of the whole day are known beforehand; who arrives is not.
- A single-phase radial feeder in the linearised DistFlow model (losses left out). Full AC power
  flow checks every executed interval, and can take the model's place at a switch on Live.
- Loads are constant power, with known reactive power; charging takes active power only.
- A vehicle that arrives between two intervals takes part from the next.
- Charging may pause and go on; a charger is off, or between its lowest and highest power.
- A contract is never changed afterwards: energy and time of return are kept whatever comes.

**What evdash decides where the paper is silent**

- Limits are on the mean of an interval. A need too small for the lowest power is met by running
  for a part of the interval.
- Each side of a limit counts by itself: what charging worsens is enforced; what it relieves or
  cannot influence is reported.
- Optimal means within one cent of a proven bound. Among plans within that cent the one whose
  energy comes earliest is taken, which leaves room for who comes next.
- A plan counts only after an independent checker has passed it; otherwise the rest of the last
  plan is kept.

Each decision with its reason and its test stands in `docs/equations.md`.
"""


def assumptions(session: Session) -> None:
    """What the model takes for granted, and what cannot be known about the original."""
    scenario = session.run.trace.scenario
    left, right = st.columns(2, gap="large")
    with left:
        st.markdown(ASSUMPTIONS)
    with right:
        st.markdown("**What could not be known about the original**")
        st.markdown(UNKNOWN)
        st.markdown(
            f"This run: {counted(scenario.station.chargers, 'charger')}, "
            f"{counted(len(scenario.option), 'price option')}, "
            f"{counted(scenario.intervals, 'interval')} of {scenario.interval_minutes} min, "
            f"{counted(len(session.run.trace.inputs.arrivals), 'arrival')}."
        )


def figures(session: Session) -> None:
    """Figures 2 to 4 with this run's numbers, each beside what the paper's text says of it."""
    trace, ahead = session.run.trace, view(session)
    left, right = st.columns([3, 2], gap="medium")
    with left:
        st.markdown("#### Fig. 2: vehicles available and selected")
        draw = admissions_figure
        chart(session, "fig2", lambda: draw(trace, ahead), admissions_alt(trace, ahead))
        table_below("fig2", lambda: admissions_table(trace, ahead))
    with right:
        _fig2(session)
    left, right = st.columns([3, 2], gap="medium")
    with left:
        st.markdown("#### Fig. 3: charging power allocation")
        chart(session, "fig3", lambda: completion_figure(trace, ahead), completion_alt(trace))
        table_below("fig3", lambda: completion_table(trace, ahead))
    with right:
        _fig3(session)
    left, right = st.columns([3, 2], gap="medium")
    with left:
        st.markdown("#### Fig. 4: load and price over the day")
        chart(session, "fig4", lambda: normalised_figure(ahead), load_alt(ahead))
        table_below("fig4", lambda: load_table(ahead))
    with right:
        _fig4(session)
    st.caption(
        "Fig. 1 of the paper is a sketch of the aggregator's algorithm; what it does is told "
        "under the equations."
    )


def _fig2(session: Session) -> None:
    trace = session.run.trace
    st.markdown("**The paper says**")
    st.markdown(
        "> In the initial off-peak hours almost all the PEVs are being selected to be charged "
        "within the committed time; not so during evening peak hours, as the base load increases "
        "and the possible time for charging decreases."
    )
    st.markdown("**This run**")
    off, off_asked = admitted_within(trace, OFF_PEAK)
    peak, peak_asked = admitted_within(trace, PEAK)
    if not off_asked and not peak_asked:
        st.markdown(NOT_YET)
        return
    st.markdown(
        f"In the paper's first off-peak hours (00:00–06:00 and 08:00–14:00) {off} of {off_asked} "
        f"who asked were admitted, in its peak hours (18:00–20:00) {peak} of {peak_asked}."
    )


def _fig3(session: Session) -> None:
    st.markdown("**The paper says**")
    st.markdown(
        "> A subset of PEVs over 10 time steps. All PEVs are shown to receive 100 % of their "
        "charging requirement. The charging rate is non-uniform and charging is discontinuous."
    )
    st.markdown("**This run**")
    found = intermittent(session.run.trace)
    if not found.over:
        st.markdown(NOT_YET)
        return
    st.markdown(
        f"Of {counted(found.over, 'vehicle')} whose time is up {found.full} got all they were "
        f"promised. {found.uneven} were charged with changing power, {found.paused} with a pause. "
        "Of plans equally good to within a cent evdash takes the one whose energy comes earliest."
    )


def _fig4(session: Session) -> None:
    st.markdown("**The paper says**")
    st.markdown(
        "> The charging station demand diminishes at high price periods to minimise cost, while it "
        "complements the network load. The charging load is normalised with the transformer "
        "rating at node 5."
    )
    st.markdown("**This run**")
    paid, mean = price_paid(session.run.trace)
    if paid is None:
        st.markdown(NOT_YET)
        return
    at_peak = station_share_at_peak(session.run.trace)
    said = f"{price_told(paid, mean)} "
    if at_peak is not None:
        said += (
            "While the feeder's load was above 90 % of its highest, the station drew "
            f"{at_peak:.0f} % of what it drew on average otherwise."
        )
    st.markdown(
        said
        + " Within what was promised only: a vehicle that comes in the evening and wants to be "
        "back soon leaves little to shift."
    )


def price_told(paid: float, mean: float) -> str:
    """What a kWh cost on average beside the plain mean of prices, both $/kWh."""
    side = "below" if paid < mean else "above"
    if f"{paid:.4f}" == f"{mean:.4f}":
        side = "the same as"
    return (
        f"A kWh for charging cost &#36;{paid:.4f} on average, {side} the mean price of the "
        f"intervals so far, &#36;{mean:.4f}."
    )
