"""Race policies: who takes part, how far it is, and what it showed."""

from functools import partial

import streamlit as st

from evdash.charts.drawn import Drawn
from evdash.charts.race import (
    load_alt,
    load_figure,
    load_rows,
    price_alt,
    price_figure,
    profit_alt,
    profit_figure,
)
from evdash.domain.trace import Inputs
from evdash.files.race_folder import Tabled, intervals_table, policies_table, refusals_table
from evdash.files.tables import write_table
from evdash.policies.race import CONTESTANTS, PAPERS, Race
from evdash.policies.race_words import ANTICIPATING, race_sentences, race_table
from evdash.policies.registry import choices, described
from evdash.ui.apart import apart, one_click
from evdash.ui.parts import show, table, table_below
from evdash.ui.race.racing import Finished, Racing, current_racing
from evdash.ui.session import Session
from evdash.ui.words import counted, plain

POLL_SECONDS = 0.5
INTRODUCTION = (
    "The present run's scenario, arrivals and events, decided from the start of the day by other "
    "policies. Foresight, statistics or a rule: what is each worth, and to whom?"
)
DRAWN = (PAPERS, ANTICIPATING, "uncoordinated")
"""Whose load is drawn at first."""


def race_panel(session: Session) -> None:
    """The part of the Compare page in which policies race."""
    racing, inputs = current_racing(), session.run.trace.inputs
    st.divider()
    st.markdown("#### Race policies")
    st.caption(INTRODUCTION)
    chosen = st.pills(
        "Who takes part",
        list(choices()),
        selection_mode="multi",
        default=list(CONTESTANTS),
        format_func=lambda name: described(name).title,
        key="race_policies",
        persist_state="session",
        help="\n\n".join(f"**{rule.title}**: {rule.told}" for rule in choices().values()),
    )
    _start(racing, inputs, list(chosen))
    _watch(racing)
    if racing.said:
        st.error(plain(racing.said), icon=":material/error:")
    if racing.finished is not None:
        _shown(racing.finished, inputs)


def _start(racing: Racing, inputs: Inputs, chosen: list[str]) -> None:
    if racing.is_running:
        st.button(
            "Stop the race",
            on_click=one_click(racing.cancel),
            key="race_stop",
            icon=":material/stop:",
        )
        return
    pressed = st.button(
        "Race",
        key="race_start",
        type="primary",
        icon=":material/flag:",
        disabled=not chosen,
        help="Takes from seconds to a minute, beside everything else.",
    )
    # not in a callback, whose arguments would be those of the page as it was before the press
    if pressed and chosen:
        racing.start(inputs, chosen)
        st.rerun()


def _watch(racing: Racing) -> None:
    """How far the race is; the fragment is there even when none is on."""
    on = racing.is_running
    apart(_beat, POLL_SECONDS if on else None)(racing, on)


def _beat(racing: Racing, on: bool) -> None:
    if not on:
        return
    stand = racing.look()
    if not racing.is_running:
        st.rerun()
    share = stand.done / stand.total if stand.total else 0.0
    told = waiting(racing.ahead) if racing.is_in_line else "Its turn comes next …"
    if stand.state == "running":
        told = "Getting ready …"
    if stand.policy:
        told = f"{described(stand.policy).title} …"
    st.progress(share, told)


def waiting(ahead: int) -> str:
    """What is said of a race that waits; `ahead` others wait before it."""
    more = f", and {counted(ahead, 'more that waits', 'more that wait')} before this one" * bool(
        ahead
    )
    return f"Waiting for the race that is on{more} …"


def _shown(finished: Finished, inputs: Inputs) -> None:
    race = finished.race
    if (inputs.given, inputs.arrivals, inputs.network) != (
        finished.inputs.given,
        finished.inputs.arrivals,
        finished.inputs.network,
    ):
        st.warning(
            "The present run has other inputs by now; this race was on those of before.",
            icon=":material/update:",
        )
    with st.container(key="race_told"):
        for sentence in race_sentences(race):
            st.markdown(f"- {plain(sentence)}")
    for name, why in race.absent.items():
        st.caption(f"{described(name).title} could not take part: {plain(why)}")
    if not race.laps:
        return
    _pictures(race)
    _reasons(race)
    st.markdown("##### All figures")
    with st.container(key="race_figures"):
        st.markdown(figures_markdown(race))
    _files(race)


def _pictures(race: Race) -> None:
    left, right = st.columns(2, gap="medium")
    with left:
        st.markdown("##### What each earned")
        show(Drawn(profit_figure(race)), "chart_race_profit", profit_alt(race))
    with right:
        there = [lap.policy for lap in race.laps]
        st.markdown("##### What each drew")
        drawn = st.pills(
            "Whose load",
            there,
            selection_mode="multi",
            default=[name for name in DRAWN if name in there] or there[:1],
            format_func=lambda name: described(name).title,
            key="race_drawn",
            label_visibility="collapsed",
        )
        show(Drawn(load_figure(race, drawn)), "chart_race_load", load_alt(race, drawn))
        table_below("race_load", lambda: load_rows(race))


def _reasons(race: Race) -> None:
    """What anticipating held each hour's room to be worth, and what it was kept for."""
    lap = race.lap(ANTICIPATING)
    if lap is None:
        return
    st.markdown("##### What bid-price kept room for")
    left, right = st.columns(2, gap="medium")
    with left:
        st.caption(
            "What a kWh of the station's capacity was expected to be worth to those still to come, "
            "when its hour came. It admits who pays more than that and the energy."
        )
        show(
            Drawn(price_figure(race, ANTICIPATING)),
            "chart_race_price",
            price_alt(race, ANTICIPATING),
        )
    with right:
        kept = [one for one in lap.turned_down if one.reason.kind == "kept for others"]
        st.caption(
            f"{len(kept)} of {len(lap.turned_down)} refusals kept room for others; the others have "
            "reasons of their own."
        )
        rows: list[dict[str, object]] = [
            {
                "Asked": f"{race.times[one.interval]:%H:%M}",
                "Vehicle": one.vehicle,
                "Option": one.option,
                "Need, kWh": round(one.need_kwh, 1),
                "Why not": str(one.reason),
            }
            for one in lap.turned_down
        ]
        table(rows, "Whom bid-price refused and why")


def figures_markdown(race: Race) -> str:
    """All figures as a table: one row each, a column for each policy."""
    heads = " | ".join(plain(lap.title) for lap in race.laps)
    lines = [f"| | {heads} |", "|:--|" + "--:|" * len(race.laps)]
    lines += [f"| {plain(head)} | {' | '.join(cells)} |" for head, cells in race_table(race)]
    return "\n".join(lines)


def _csv(tabled: Tabled, race: Race) -> str:
    return write_table(*tabled(race))


def _files(race: Race) -> None:
    with st.container(horizontal=True):
        for label, name, tabled in (
            ("Figures as CSV", "policies.csv", policies_table),
            ("Every interval as CSV", "intervals.csv", intervals_table),
            ("Refusals as CSV", "refusals.csv", refusals_table),
        ):
            st.download_button(
                label,
                data=partial(_csv, tabled, race),
                file_name=f"race-{name}",
                mime="text/csv",
                on_click="ignore",
                key=f"race_{name}",
                icon=":material/download:",
            )
