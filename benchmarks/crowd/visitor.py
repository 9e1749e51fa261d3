"""A visitor without a browser: Streamlit's own messages over its WebSocket.

Does what the browser's side does as far as the server can tell: runs scripts, presses buttons,
keeps widgets' values, rings fragments' timers, follows the address. It draws nothing.
"""

import asyncio
import re
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import parse_qs

import websockets
from google.protobuf.message import Message
from streamlit.proto.BackMsg_pb2 import BackMsg
from streamlit.proto.ForwardMsg_pb2 import ForwardMsg
from streamlit.proto.WidgetStates_pb2 import WidgetState, WidgetStates

PATIENCE_SECONDS = 180.0
DECIDED = re.compile(r"(\d+) of \d+ interval")


@dataclass(slots=True)
class Visitor:
    """One tab. `received` counts bytes; `texts` is everything the last whole run showed."""

    address: str
    headers: dict[str, str] = field(default_factory=dict)
    socket: Any = None
    session: str = ""
    query: str = ""
    page: str = ""
    pages: dict[str, str] = field(default_factory=dict)
    widgets: dict[str, str] = field(default_factory=dict)
    shown: dict[tuple[int, ...], Message] = field(default_factory=dict)
    exceptions: list[str] = field(default_factory=list)
    received: int = 0
    on_message: Callable[[bytes], None] = lambda data: None
    _timers: dict[str, asyncio.Task[None]] = field(default_factory=dict)
    _reader: asyncio.Task[None] | None = None
    _settled: asyncio.Event = field(default_factory=asyncio.Event)
    _running: bool = False

    async def open(self, query: str = "", page: str = "") -> None:
        """Connect and run the page once."""
        where = self.address.replace("http", "ws", 1) + "/_stcore/stream"
        protocols = ["streamlit", "none", self.session] if self.session else ["streamlit"]
        self.socket = await websockets.connect(
            where,
            subprotocols=[websockets.Subprotocol(name) for name in protocols],
            additional_headers=self.headers,
            origin=websockets.Origin(self.address),
            max_size=None,
            open_timeout=PATIENCE_SECONDS,
            ping_interval=None,
        )
        self.query = query
        self._reader = asyncio.create_task(self._read())
        await self._ask(page_name=page)
        await self.settled()

    async def close(self) -> None:
        """Close the tab."""
        self._stop_timers()
        if self._reader is not None:
            self._reader.cancel()
        if self.socket is not None:
            await self.socket.close()

    async def press(self, key: str, *, wait: bool = True) -> float:
        """Press a button by its key; the seconds until the page has settled."""
        began = time.perf_counter()
        trigger = WidgetState(id=self.widgets[key], trigger_value=True)
        await self._ask(WidgetStates(widgets=[trigger]))
        if wait:
            await self.settled()
        return time.perf_counter() - began

    async def turn_to(self, page: str, *, wait: bool = True) -> float:
        """Go to another page by its name in the address; the seconds until it has settled."""
        began = time.perf_counter()
        await self._ask(page_hash=self.pages[page])
        if wait:
            await self.settled()
        return time.perf_counter() - began

    async def settled(self) -> None:
        """Wait until no script runs for this tab."""
        await asyncio.wait_for(self._settled.wait(), PATIENCE_SECONDS)

    @property
    def link(self) -> str:
        """The link of the run, as the address has it."""
        return parse_qs(self.query).get("run", [""])[0]

    @property
    def steps_shown(self) -> int | None:
        """How many steps the page says were taken; None where it does not say."""
        found = (DECIDED.search(text) for text in self.texts())
        return next((int(match[1]) for match in found if match), None)

    def texts(self) -> Iterator[str]:
        """Every text on the page, chart data included."""
        for message in self.shown.values():
            yield from _texts(message)

    async def _ask(
        self,
        states: WidgetStates | None = None,
        page_hash: str | None = None,
        page_name: str = "",
        fragment: str = "",
    ) -> None:
        if not fragment:
            self._settled.clear()
        message = BackMsg()
        script = message.rerun_script
        script.query_string = self.query
        script.page_script_hash = self.page if page_hash is None else page_hash
        script.page_name = page_name
        script.fragment_id = fragment
        script.is_auto_rerun = bool(fragment)
        script.context_info.timezone = "UTC"
        script.context_info.url = f"{self.address}/"
        if states is not None:
            script.widget_states.CopyFrom(states)
        await self.socket.send(message.SerializeToString())

    async def _read(self) -> None:
        async for data in self.socket:
            self.received += len(data)
            self.on_message(data)
            message = ForwardMsg()
            message.ParseFromString(data)
            self._take(message)

    def _take(self, message: ForwardMsg) -> None:
        kind = message.WhichOneof("type")
        whole = not message.metadata.run.fragment_ids
        if kind == "new_session":
            self.session = message.new_session.initialize.session_id or self.session
            self._running = True
            if whole:
                self._begin(message.new_session)
        elif kind == "delta":
            self._show(message)
        elif kind == "page_info_changed":
            self.query = message.page_info_changed.query_string
        elif kind == "navigation":
            self._navigate(message.navigation)
        elif kind == "auto_rerun":
            self._set_timer(message.auto_rerun.fragment_id, message.auto_rerun.interval)
        elif kind == "script_finished":
            self._running = False
            if whole and message.script_finished == ForwardMsg.FINISHED_SUCCESSFULLY:
                self._settled.set()

    def _begin(self, new: Any) -> None:
        """A whole run begins: what was shown goes, and so do the timers of its fragments."""
        self._settled.clear()
        self.page = new.page_script_hash or self.page
        self.shown.clear()
        self._stop_timers()

    def _stop_timers(self) -> None:
        for timer in self._timers.values():
            timer.cancel()
        self._timers.clear()

    def _navigate(self, navigation: Any) -> None:
        self.page = navigation.page_script_hash or self.page
        for page in navigation.app_pages:
            self.pages[page.url_pathname or "live"] = page.page_script_hash

    def _show(self, message: ForwardMsg) -> None:
        delta = message.delta
        self.shown[tuple(message.metadata.delta_path)] = delta
        if delta.WhichOneof("type") != "new_element":
            return
        element = delta.new_element
        what = getattr(element, element.WhichOneof("type") or "empty")
        if element.WhichOneof("type") == "exception":
            self.exceptions.append(f"{what.type}: {what.message}")
        widget = getattr(what, "id", "")
        if isinstance(widget, str) and widget.startswith("$$ID-"):
            self.widgets[widget.split("-", 2)[2]] = widget

    def _set_timer(self, fragment: str, seconds: float) -> None:
        async def ring() -> None:
            while True:
                await asyncio.sleep(seconds)
                if not self._running:
                    await self._ask(fragment=fragment)

        known = self._timers.pop(fragment, None)
        if known is not None:
            known.cancel()
        self._timers[fragment] = asyncio.create_task(ring())


def _texts(message: Message) -> Iterator[str]:
    for descriptor, value in message.ListFields():
        values = value if descriptor.is_repeated else [value]
        for part in values:
            if isinstance(part, str):
                yield part
            elif isinstance(part, Message):
                yield from _texts(part)
