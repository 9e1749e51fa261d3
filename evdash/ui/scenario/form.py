"""The draft in sections: day and station, feeder, prices and loads, vehicles, the text itself."""

from functools import partial

import streamlit as st

from evdash.domain.arrivals import GeneratedArrivals, RecordedArrivals
from evdash.domain.events import EVENT_FORMS
from evdash.domain.scenario import Feeder, Scenario, Station
from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import drawn, listed, read_settings, settings_text
from evdash.files.scenario_folder import SETTINGS
from evdash.ui.scenario import fields
from evdash.ui.scenario.editor import Editor, Said
from evdash.ui.scenario.fields import bound
from evdash.ui.scenario.options import hourly_share, options, statistics_path
from evdash.ui.scenario.tables import table
from evdash.ui.session import bundled
from evdash.ui.words import markdown_table

TABS = ("Day and station", "Feeder", "Prices and loads", "Vehicles", "Events", "As text")
KINDS = {False: "Drawn at random", True: "From a list"}


def form(editor: Editor) -> None:
    """All sections; only the one that is open is drawn."""
    tabs = st.tabs(TABS, key="scenario_tabs", on_change="rerun")
    sections = (day_and_station, feeder, profile, vehicles, events, as_text)
    for tab, section in zip(tabs, sections, strict=True):
        if tab.open:
            with tab:
                section(editor)


def day_and_station(editor: Editor) -> None:
    """The clock, the station and its price options."""
    top, station = Scenario.model_fields, Station.model_fields
    left, middle, right = st.columns([4, 4, 5], gap="medium")
    with left:
        st.markdown("#### Day")
        fields.text(editor, ("name",), top["name"])
        fields.text(editor, ("start",), top["start"])
        for key in ("interval_minutes", "intervals", "arrivals_until"):
            fields.number(editor, (key,), top[key], whole=True)
    with middle:
        st.markdown("#### Station")
        fields.choice(editor, ("station", "node"), station["node"], node_names(editor))
        fields.number(editor, ("station", "chargers"), station["chargers"], whole=True)
        for key in ("min_kw", "max_kw", "efficiency"):
            fields.number(editor, ("station", key), station[key])
    with right:
        st.markdown("#### Price options")
        st.caption("What drivers can choose between. Add a row below the last one.")
        options(editor)


def feeder(editor: Editor) -> None:
    """Where the feeder begins, its voltages and bases; its nodes and lines."""
    declared = Feeder.model_fields
    columns = st.columns(4, gap="medium")
    with columns[0]:
        names = node_names(editor)
        fields.choice(editor, ("feeder", "source_node"), declared["source_node"], names)
    numbers = [name for name in declared if name != "source_node"]
    for place, name in enumerate(numbers, 1):
        with columns[place % 4]:
            fields.number(editor, ("feeder", name), declared[name])
    left, right = st.columns([4, 3], gap="medium")
    with left:
        st.markdown("#### Nodes")
        table(editor, "nodes.csv", "Loads are peak values, three-phase totals. Blank means none.")
    with right:
        st.markdown("#### Lines")
        told = "Lines, switches and transformers: positive-sequence ohms at the nominal voltage."
        table(editor, "lines.csv", told)


def profile(editor: Editor) -> None:
    """Energy price, load and generation of every interval."""
    table(editor, "profile.csv", "One row for each interval, counted from 0.")


def vehicles(editor: Editor) -> None:
    """Who arrives: drawn from statistics, or one by one from a list."""
    _kind(editor)
    declared = GeneratedArrivals.model_fields
    if editor.draft.is_recorded:
        seed = RecordedArrivals.model_fields["seed"]
        table(
            editor,
            "arrivals.csv",
            "One row for each vehicle. Whoever arrives between two intervals takes part from "
            "the next.",
        )
        st.markdown("#### What may be known of arrivals beforehand")
        fields.number(editor, ("arrivals", "seed"), seed, whole=True)
    path = statistics_path(editor)
    if not isinstance(editor.get(path), dict):
        return
    left, middle, right = st.columns([4, 4, 5], gap="medium")
    with left:
        if not editor.draft.is_recorded:
            fields.number(editor, ("arrivals", "seed"), declared["seed"], whole=True)
        fields.number(editor, (*path, "vehicles_per_day"), declared["vehicles_per_day"])
        fields.pair(editor, (*path, "soc_out"), declared["soc_out"], ("lowest", "highest"))
        fields.pair(editor, (*path, "soc_in_beta"), declared["soc_in_beta"], ("a", "b"))
    with middle:
        st.markdown("#### Arrivals by the hour")
        hourly_share(editor)
    with right:
        st.markdown("#### Vehicle models")
        table(editor, "fleet.csv", "Models vehicles are drawn from, by how often they come.")


def events(editor: Editor) -> None:
    """What happens on the way, and what each kind of event means."""
    told = (
        "What happens on the way: known from the start of its interval on, never before. Leave "
        "the table empty for a day on which nothing happens."
    )
    table(editor, "events.csv", told)
    with st.expander("What can happen"):
        rows: list[dict[str, object]] = [
            {"event": kind, "means": form.meaning.replace("`", "")}
            for kind, form in EVENT_FORMS.items()
        ]
        st.markdown(markdown_table(rows))


def _kind(editor: Editor) -> None:
    """The switch between drawn and listed vehicles; either way what is there is carried over."""
    key = bound(editor, "kind", editor.draft.is_recorded, partial(_switch, editor))
    st.segmented_control(
        "Where vehicles come from",
        list(KINDS),
        format_func=KINDS.__getitem__,
        key=key,
        required=True,
        help="Drawn at random from statistics and a seed, or given one by one. Switching to a "
        "list begins with the vehicles that would be drawn.",
    )


def _switch(editor: Editor, is_recorded: bool) -> None:
    try:
        changed = listed(editor.draft) if is_recorded else drawn(editor.draft, bundled(DEFAULT))
    except InputError as error:
        title = "The vehicles cannot be drawn before these faults are mended."
        editor.said = Said(title, error.faults)
    else:
        editor.take(changed)


def as_text(editor: Editor) -> None:
    """scenario.toml itself, for whatever the other sections cannot show."""
    st.caption(
        "What the other sections show, as the file `scenario.toml` has it. Every key is "
        "explained in `docs/scenario.md`."
    )
    told = settings_text(editor.draft.settings) if editor.text is None else editor.text
    key = bound(editor, "text", told, partial(_take_text, editor))
    st.text_area("scenario.toml", key=key, height=560, help=f"The text of {SETTINGS}.")


def _take_text(editor: Editor, text: str) -> None:
    settings, faults = read_settings(text.encode())
    if faults:
        editor.text = text
        editor.said = Said("The text is not taken over yet.", tuple(faults))
    else:
        editor.take(editor.draft.with_settings(settings))


def node_names(editor: Editor) -> list[str]:
    """Names of all nodes in the draft."""
    return [row["node"] for row in editor.draft.tables.get("nodes.csv", ()) if row["node"]]
