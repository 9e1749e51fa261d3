"""Charts of all runs over each other, and what differs in their inputs."""

import streamlit as st

from evdash.charts.comparison import Compared, overlay_alt, overlay_figure, overlay_table
from evdash.charts.drawn import Drawn
from evdash.charts.style import CONFIG
from evdash.files.differences import scenario_differences
from evdash.metrics.outlook import outlook
from evdash.ui.compare.figures import figures
from evdash.ui.compare.pins import Held
from evdash.ui.parts import table_below
from evdash.ui.settings import NETWORK_NAMES, edit_log
from evdash.ui.words import markdown_table, plain

LOADS = ("Station load", "Headroom", "Energy price")
ADMISSIONS = ("Admitted", "Refused")


def comparison(held: list[Held]) -> None:
    """Figures, what differs in the inputs, and the charts; nothing where there is one run only."""
    if len(held) < 2:
        return
    names = [run.name for run in held]
    against = st.selectbox(
        "Compare against",
        names,
        key="against",
        persist_state="session",
        width=420,
        help="Differences are to this run.",
    )
    base = next((run for run in held if run.name == against), held[0])
    left, right = st.columns([3, 2], gap="medium")
    with left:
        st.markdown("#### What came of it")
        figures(held, base)
    with right:
        st.markdown("#### What differs in the inputs")
        for run in held:
            if run is not base:
                differences(base, run)
    runs = [Compared(run.name, run.common, outlook(run.common)) for run in held]
    st.space("small")
    left, right = st.columns(2, gap="medium")
    with left:
        _chart(runs, "Load and price", "compare_load", LOADS)
    with right:
        _chart(runs, "Admissions", "compare_admissions", ADMISSIONS)
    _chart(runs, "Lowest voltage", "compare_voltage", ("Lowest voltage",))


def _chart(runs: list[Compared], title: str, key: str, quantities: tuple[str, ...]) -> None:
    quantity = quantities[0]
    with st.container(horizontal=True, vertical_alignment="center", key=f"{key}_head"):
        st.markdown(f"#### {title}", width="content")
        if len(quantities) > 1:
            quantity = st.segmented_control(
                "What to show",
                quantities,
                default=quantity,
                required=True,
                key=f"{key}_way",
                label_visibility="collapsed",
                persist_state="session",
            )
    st.plotly_chart(
        Drawn(overlay_figure(runs, quantity)),
        key=f"chart_{key}",
        config=CONFIG,
        alt=overlay_alt(runs, quantity),
    )
    table_below(key, lambda: overlay_table(runs, quantity))


def differences(base: Held, run: Held) -> None:
    """Key by key what `run` has that `base` has not, as the inputs stand at its end."""
    rows: list[dict[str, object]] = [
        {"Where": one.place, base.name: one.before, run.name: one.after}
        for one in scenario_differences(base.scenario, run.scenario)
    ]
    networks = [NETWORK_NAMES[held.whole.inputs.network] for held in (base, run)]
    if networks[0] != networks[1]:
        rows.append({"Where": "limits kept in", base.name: networks[0], run.name: networks[1]})
    if rows:
        st.markdown(markdown_table(rows))
    else:
        st.caption(f"The inputs of {plain(run.name)} are the same.")
    log = edit_log(run.whole, run.run.opened, outlook(run.whole))
    if run.whole.steps and log:
        st.caption(f"{plain(run.name)} was changed on the way:  \n" + "  \n".join(log))
