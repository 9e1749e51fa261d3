"""Charts of all runs over each other, and what differs in their inputs."""

import streamlit as st

from evdash.charts.comparison import Compared, overlay_alt, overlay_figure, overlay_table
from evdash.charts.drawn import Drawn
from evdash.files.differences import scenario_differences
from evdash.metrics.outlook import outlook
from evdash.ui.compare.figures import figures, short
from evdash.ui.compare.pins import Held
from evdash.ui.glossary import meaning
from evdash.ui.parts import show, table_below
from evdash.ui.settings import NETWORK_NAMES, edit_log
from evdash.ui.words import markdown_table, plain

LOADS = ("Station load", "Headroom", "Energy price")
MOST_BESIDE = 2
"""With more runs than these the figures take the whole width."""
ADMISSIONS = ("Admitted", "Refused")


def reference(held: list[Held]) -> Held | None:
    """The run that others are compared against; none where there is one run only."""
    if len(held) < 2:
        return None
    against = st.selectbox(
        "Compare against",
        [run.name for run in held],
        key="against",
        persist_state="session",
        help="Differences are to this run.",
    )
    return next((run for run in held if run.name == against), held[0])


def comparison(held: list[Held], base: Held | None) -> None:
    """Figures, what differs in the inputs, and the charts."""
    if base is None:
        return
    runs = [Compared(run.name, run.common, outlook(run.common)) for run in held]
    wide = st.container() if len(held) > MOST_BESIDE else None
    left, right = st.columns(2, gap="medium")
    with wide or left:
        st.markdown("#### What came of it", help=meaning("AC power flow"))
        figures(held, base)
    with left if wide else right:
        st.markdown("#### What differs in the inputs")
        for run in held:
            if run is not base:
                differences(base, run)
    with right:
        _chart(runs, "Load and price", "compare_load", LOADS, "Headroom")
    st.space("small")
    left, right = st.columns(2, gap="medium")
    with left:
        _chart(runs, "Admissions", "compare_admissions", ADMISSIONS, "Admitted")
    with right:
        _chart(runs, "Lowest voltage", "compare_voltage", ("Lowest voltage",), "pu")


def _chart(
    runs: list[Compared], title: str, key: str, quantities: tuple[str, ...], term: str
) -> None:
    quantity = quantities[0]
    with st.container(horizontal=True, vertical_alignment="center", key=f"{key}_head"):
        st.markdown(f"#### {title}", width="content", help=f"{term}: {meaning(term)}")
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
    show(Drawn(overlay_figure(runs, quantity)), f"chart_{key}", overlay_alt(runs, quantity))
    table_below(key, lambda: overlay_table(runs, quantity))


def differences(base: Held, run: Held) -> None:
    """Key by key what `run` has that `base` has not, as the inputs stand at its end."""
    here, there = short(base.name), short(run.name)
    if here == there:
        here = f"{here} (against)"
    rows: list[dict[str, object]] = [
        {"Where": one.place, here: one.before, there: one.after}
        for one in scenario_differences(base.scenario, run.scenario)
    ]
    networks = [NETWORK_NAMES[held.whole.inputs.network] for held in (base, run)]
    if networks[0] != networks[1]:
        rows.append({"Where": "limits kept in", here: networks[0], there: networks[1]})
    if rows:
        st.markdown(markdown_table(rows))
    else:
        st.caption(f"The inputs of {plain(run.name)} are the same.")
    log = edit_log(run.whole, run.run.opened, outlook(run.whole))
    if log and any(step.inputs is not run.whole.steps[0].inputs for step in run.whole.steps):
        st.caption(f"{plain(run.name)} was changed on the way:  \n" + "  \n".join(log))
