"""A network on its way in: which one, where it is supplied, where the station stands."""

import streamlit as st

from evdash.errors import InputError
from evdash.grid.nets.shipped import SHIPPED
from evdash.imports.feeder import (
    ImportedFeeder,
    shipped_net,
    station_in,
    supplies_of,
    with_network,
)
from evdash.imports.pandapower_json import decoded_json, is_pandapower, read_net
from evdash.ui.apart import one_click
from evdash.ui.scenario.editor import Editor, Said
from evdash.ui.scenario.outcome import fault_table
from evdash.ui.scenario.waiting import WaitingNetwork
from evdash.ui.words import counted, plain

SHIPPED_KEY = "shipped_network"


def is_network(name: str, content: bytes) -> bool:
    """Whether a file is a pandapower network; InputError where it is JSON by name only."""
    return name.lower().endswith(".json") and is_pandapower(decoded_json(name, content))


def read_network(name: str, content: bytes, number: int) -> WaitingNetwork:
    """An uploaded network, to wait; InputError where it cannot be read."""
    return WaitingNetwork(name, *read_net(name, content), number)


def shipped_choice(editor: Editor) -> None:
    """A network that pandapower ships, by its name."""
    st.selectbox(
        "Or put the station on a known network",
        list(SHIPPED),
        index=None,
        format_func=lambda name: f"{name}: {SHIPPED[name]}",
        placeholder="33-bus, CIGRE, …",
        key=SHIPPED_KEY,
        on_change=_shipped,
        args=(editor,),
        help="Networks that pandapower ships. One is converted and shown first; nothing is "
        "replaced before you take it in.",
        width=400,
    )


def _shipped(editor: Editor) -> None:
    name = st.session_state[SHIPPED_KEY]
    if name is not None:
        editor.network = WaitingNetwork(name, *shipped_net(name), editor.next_number())
        editor.said = None


def feeder_form(editor: Editor) -> None:
    """Where the waiting network is supplied and the station stands, and how it was converted."""
    waiting = editor.network
    if waiting is None:
        return
    with st.container(border=True, key="network_form"):
        name = plain(waiting.name)
        st.markdown(f"**{name}** waits: nothing is replaced before you take it in.")
        places = iter(st.columns(2))
        source = None
        if len(supplies_of(waiting.net)) > 1:
            with next(places):
                source = _source(waiting)
        try:
            with st.spinner("Converting, and comparing with the network's own AC power flow"):
                imported = waiting.feeder(source)
        except InputError as error:
            st.error(f"**{name} cannot be a feeder here as it is.**", icon=":material/block:")
            fault_table(error.faults)
            _leave_button(editor)
            return
        with next(places):
            _station(editor, waiting, imported, source)
        with st.expander(f"How {name} is converted"):
            st.markdown("\n".join(f"- {plain(note)}" for note in imported.notices))
        with st.container(horizontal=True):
            st.button(
                "Take the network in",
                on_click=one_click(_take),
                args=(editor,),
                key="confirm_network",
                type="primary",
                icon=":material/check:",
                help="It replaces nodes, lines and what [feeder] says; Undo brings them back.",
            )
            _leave_button(editor)


def _source(waiting: WaitingNetwork) -> str:
    supplies = supplies_of(waiting.net)
    return st.selectbox(
        "Supplied from",
        list(supplies),
        format_func=supplies.__getitem__,
        key=_source_key(waiting),
        help="The file has several external grids. A feeder has one; what another supplies is "
        "left out.",
    )


def _station(
    editor: Editor, waiting: WaitingNetwork, imported: ImportedFeeder, source: str | None
) -> None:
    feeder = imported.feeder
    loads = {node.node: node.load_kw for node in feeder.nodes if node.node != feeder.source_node}
    usual = station_in(editor.draft, feeder)
    st.selectbox(
        f"The station stands at, of {counted(len(loads), 'node')} and {feeder.load_kw:,.0f} kW",
        list(loads),
        index=list(loads).index(usual),
        format_func=lambda node: f"{node} · {loads[node] or 0:,.4g} kW of load",
        key=_station_key(waiting, source),
        help="Proposed is the node the station has now, where there is one of that name; else "
        "the one with the largest load.",
    )


def _source_key(waiting: WaitingNetwork) -> str:
    return f"network:{waiting.number}:source"


def _station_key(waiting: WaitingNetwork, source: str | None) -> str:
    return f"network:{waiting.number}:{source}:station"


def _take(editor: Editor) -> None:
    """Take in what the form says at the press, which may have come right after a choice in it."""
    waiting = editor.network
    if waiting is None:
        return
    source = st.session_state.get(_source_key(waiting))
    station = st.session_state.get(_station_key(waiting, source))
    if station is None:
        st.toast("Another supply was chosen just now: see where the station stands, then go on.")
        return
    imported = waiting.feeder(source)
    changed, told = with_network(editor.draft, imported, station)
    editor.network = st.session_state[SHIPPED_KEY] = None
    said = f"{plain(waiting.name)} replaced the feeder; the station stands at {plain(station)}."
    editor.take(changed, Said(said, notes=(*imported.notices, *told)))


def _leave_button(editor: Editor) -> None:
    st.button("Leave it", on_click=_leave, args=(editor,), key="leave_network")


def _leave(editor: Editor) -> None:
    editor.network = st.session_state[SHIPPED_KEY] = None
    editor.said = None
