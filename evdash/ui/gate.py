"""How many pages are open and how much is on its way in: held to the quotas before Streamlit.

Streamlit keeps every uploaded file in memory for as long as its tab is open, and takes any number
of tabs. Here both are counted as they come; what there is no room for is refused in words.
"""

import re
from collections import Counter, OrderedDict
from collections.abc import Callable, Mapping

import streamlit as st
from starlette.datastructures import Headers
from starlette.middleware import Middleware
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Receive, Scope, Send
from streamlit import runtime
from streamlit.runtime.memory_uploaded_file_manager import MemoryUploadedFileManager
from streamlit.runtime.scriptrunner import get_script_run_ctx

from evdash.domain.quotas import TABS, UPLOADED_BYTES, QuotaReached
from evdash.ui.visitors import visitor_at

STREAM = "/_stcore/stream"
UPLOAD = re.compile(r"/_stcore/upload_file/([^/]+)/[^/]+/?$")
UNAVAILABLE, TRY_AGAIN_LATER = 503, 1013
NOT_KEPT = 200
"""Of a file: an error would be told by the browser, as a number, and never reach the page."""
MOST_REFUSED = 1_000
PAGES = ("document", "iframe", "")
"""What a browser says it fetches when it opens a page; one that says nothing may."""


def _kept_bytes() -> Mapping[str, int]:
    """Bytes of uploaded files that Streamlit holds, by session."""
    files = runtime.get_instance().uploaded_file_mgr
    if not isinstance(files, MemoryUploadedFileManager):
        return {}
    held = list(files.file_storage.items())
    return {session: sum(len(file.data) for file in list(of.values())) for session, of in held}


class Uploads:
    """Bytes on their way in, by session, beside those that `kept` tells of."""

    def __init__(self, kept: Callable[[], Mapping[str, int]] = _kept_bytes) -> None:
        self._kept = kept
        self._coming: Counter[str] = Counter()
        self._visitors: dict[str, str | None] = {}
        self._refused: OrderedDict[str, str] = OrderedDict()

    def begin(self, session: str, visitor: str | None, size: int) -> None:
        """Count a file that is about to come; raises QuotaReached where there is no room.

        All tabs of a visitor count as one; those of nobody known, each by itself.
        """
        held = Counter(self._kept()) + self._coming
        known = self._visitors = {one: who for one, who in self._visitors.items() if one in held}
        known[session] = visitor
        own = sum(
            held[one]
            for one, who in known.items()
            if one == session or (visitor and who == visitor)
        )
        try:
            UPLOADED_BYTES.check(own, held.total(), size)
        except QuotaReached as full:
            self._refused[session] = str(full)
            if len(self._refused) > MOST_REFUSED:
                self._refused.popitem(last=False)
            raise
        self._coming[session] += size

    def end(self, session: str, size: int) -> None:
        """It has come, or never will."""
        self._coming[session] -= size
        self._coming += Counter()  # forgets who has nothing on its way

    def told(self, session: str) -> str:
        """Why a file of a session was refused since this was asked last; empty if none was."""
        return self._refused.pop(session, "")


uploads = Uploads()


class WithinQuotas:
    """ASGI middleware: refuses pages and files that there is no room for."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._open: Counter[str | None] = Counter()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request or handshake, or hand it on."""
        path = scope.get("path", "")
        if scope["type"] == "websocket" and path.endswith(STREAM):
            await self._stream(scope, receive, send)
        elif scope["type"] == "http" and scope["method"] == "PUT" and (at := UPLOAD.search(path)):
            await self._upload(scope, receive, send, at[1])
        elif scope["type"] == "http" and scope["method"] == "GET" and _is_page(scope, path):
            await self._page(scope, receive, send)
        else:
            await self.app(scope, receive, send)

    def _check(self, scope: Scope) -> str | None:
        """The visitor who opens a page; raises QuotaReached where there is no room for it."""
        visitor = _visitor(scope)
        TABS.check(self._open[visitor] if visitor else 0, self._open.total())
        return visitor

    async def _stream(self, scope: Scope, receive: Receive, send: Send) -> None:
        try:
            visitor = self._check(scope)
        except QuotaReached:
            await receive()  # the handshake, which is answered with a 403
            await send({"type": "websocket.close", "code": TRY_AGAIN_LATER, "reason": ""})
            return
        self._open[visitor] += 1
        try:
            await self.app(scope, receive, send)
        finally:
            self._open[visitor] -= 1
            self._open += Counter()

    async def _page(self, scope: Scope, receive: Receive, send: Send) -> None:
        """The frame of a page, or why it would stay empty."""
        try:
            self._check(scope)
        except QuotaReached as full:
            await _say(scope, receive, send, UNAVAILABLE, full)
        else:
            await self.app(scope, receive, send)

    async def _upload(self, scope: Scope, receive: Receive, send: Send, session: str) -> None:
        size = _declared_bytes(scope)
        try:
            uploads.begin(session, _visitor(scope), size)
        except QuotaReached as full:
            await _let_pass(receive)
            await _say(scope, receive, send, NOT_KEPT, full)
            return
        try:
            await self.app(scope, receive, send)
        finally:
            uploads.end(session, size)


MIDDLEWARE = [Middleware(WithinQuotas)]


def _visitor(scope: Scope) -> str | None:
    return visitor_at(scope["client"][0] if scope.get("client") else None)


def _is_page(scope: Scope, path: str) -> bool:
    """Whether a request opens a page: no file, and none of Streamlit's own addresses."""
    fetched = Headers(scope=scope).get("sec-fetch-dest", "")
    return "." not in path and "/_stcore/" not in path and fetched in PAGES


def _declared_bytes(scope: Scope) -> int:
    """How large a request says it is; as large as any may be where it does not say."""
    declared = Headers(scope=scope).get("content-length", "")
    most: int = st.get_option("server.maxUploadSize") * 1024 * 1024
    return min(int(declared), most) if declared.isdecimal() else most


async def _let_pass(receive: Receive) -> None:
    """Take a body off the line without keeping it: a browser hears no answer before its end."""
    left = 2 * UPLOADED_BYTES.each
    while left > 0:
        message = await receive()
        left -= len(message.get("body", b""))
        if message["type"] != "http.request" or not message.get("more_body"):
            return


async def _say(scope: Scope, receive: Receive, send: Send, status: int, full: QuotaReached) -> None:
    await PlainTextResponse(f"{full}\n", status_code=status)(scope, receive, send)


def refused_here() -> str:
    """Why a file for this tab was refused since this was asked last; empty if none was."""
    run = get_script_run_ctx()
    return uploads.told(run.session_id) if run else ""


def let_go() -> None:
    """Free the memory of all files of this tab: they have been taken in or refused."""
    run = get_script_run_ctx()
    if run is not None:
        run.uploaded_file_mgr.remove_session_files(run.session_id)
