"""All vehicles: filter, order, who charges when, and a table to pick from."""

import pandas as pd
import streamlit as st

from evdash.charts.drawn import Drawn
from evdash.charts.fleet import fleet_alt, fleet_figure, fleet_table
from evdash.domain.digest import digest
from evdash.domain.outlook import Outlook
from evdash.metrics.records import VehicleRecord, vehicle_records
from evdash.metrics.vehicles import charging_kw
from evdash.ui.parts import show, view
from evdash.ui.session import Session
from evdash.ui.vehicles.choice import GROUPS, ORDERS, Choice, chosen
from evdash.ui.vehicles.picked import pick_clicked, pick_drawn
from evdash.ui.vehicles.words import STATUS_CELLS, counted_line

FLEET = "chart_fleet"
TABLE_PX = 640
COLUMNS = {
    "Vehicle": st.column_config.TextColumn(pinned=True),
    "Due back": st.column_config.TextColumn(help="Promised by then, or asked for in vain."),
    "Asks, kWh": st.column_config.NumberColumn(format="%.1f", help="From the grid, losses too."),
    "Got, kWh": st.column_config.NumberColumn(format="%.1f"),
    "Now, kW": st.column_config.NumberColumn(
        format="%.1f", help="Mean power in the interval decided last."
    ),
    "Pays, $": st.column_config.NumberColumn(format="%.2f"),
}
CHART_HELP = (
    "One line a vehicle. Outlined: from arrival to the promised return; crossed out: refused. "
    "Solid: charged; hatched: planned; the thicker, the higher the power. Click a bar to look at "
    "that vehicle. Beyond 60 vehicles colour stands for power; pick from the table then."
)


def listing(session: Session, picked: str) -> None:
    """The vehicles somebody wants to see, as a chart and as a table."""
    trace, ahead = session.run.trace, view(session)
    records = session.once("vehicle_records", lambda: vehicle_records(trace))
    wish = _filters(session)
    shown = session.once(
        "vehicles_shown", lambda: chosen(records, charging_kw(trace), wish), detail=wish
    )
    st.markdown(f"#### {counted_line(len(shown), len(records))}", help=CHART_HELP)
    drawn, told = st.tabs(["Chart", "Table"])
    with drawn:
        _chart(session, shown, (wish, picked))
    with told:
        _table(session, shown, ahead)


def _chart(session: Session, shown: tuple[VehicleRecord, ...], detail: tuple[Choice, str]) -> None:
    """A line a vehicle; a click on it picks the vehicle."""
    trace, ahead = session.run.trace, view(session)
    figure = session.once(
        "figure:fleet", lambda: fleet_figure(trace, ahead, shown, detail[1]), detail=detail
    )
    names = [record.vehicle for record in shown]
    show(
        Drawn(figure),
        FLEET,
        fleet_alt(shown, ahead),
        on_select=lambda: pick_drawn(FLEET, names),
        selection_mode="points",
    )


def _filters(session: Session) -> Choice:
    """What to show, and in what order."""
    options = [option.name for option in session.run.trace.scenario.option]
    group = st.segmented_control(
        "Show",
        GROUPS,
        default=GROUPS[0],
        required=True,
        key="vehicles_group",
        persist_state="session",
        help="Charging now: with power in the interval decided last.",
    )
    left, middle, right = st.columns([1.1, 1.2, 1], gap="small", vertical_alignment="bottom")
    text = left.text_input(
        "Search",
        key="vehicles_text",
        icon=":material/search:",
        placeholder="Name or reason",
        max_chars=60,
        persist_state="session",
        help="Part of a vehicle's name, or of the reason for which it was refused.",
    )
    order = middle.selectbox(
        "Sort by",
        list(ORDERS),
        key="vehicles_order",
        persist_state="session",
        help="Energy asked and revenue: largest first. Revenue: what a vehicle pays.",
    )
    with right:
        taken = st.multiselect(
            "Price option",
            options,
            key="vehicles_options",
            placeholder="All",
            persist_state="session",
            help="Only vehicles that chose one of these.",
        )
    return Choice(str(group), tuple(taken), text, order)


def _table(session: Session, shown: tuple[VehicleRecord, ...], ahead: Outlook) -> None:
    """A row a vehicle; a click on it picks the vehicle."""
    names = [record.vehicle for record in shown]
    now_kw = charging_kw(session.run.trace)
    rows = fleet_table(shown, now_kw, STATUS_CELLS, ahead)
    # another list is another table, so that no row stays marked that is another vehicle's now
    key = f"vehicles_table:{session.run.trace.now}:{digest(names).hex()}"
    st.caption("Click a row's box to look at that vehicle.")
    st.dataframe(
        pd.DataFrame(rows),
        key=key,
        hide_index=True,
        height=TABLE_PX if len(rows) > 16 else "auto",
        on_select=lambda: pick_clicked(key, names),
        selection_mode="single-row",
        column_config=COLUMNS,
        alt="Vehicles listed, with what they asked for, were promised and pay",
    )
