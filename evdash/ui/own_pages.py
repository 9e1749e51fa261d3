"""Who may speak to the server: its own pages, under the names it goes by.

Any site open in a visitor's browser can call `localhost`. Streamlit answers a WebSocket's foreign
`Origin` by asking the outside for this machine's address, in the loop that serves everyone. Here
that is settled first, from what is known, and nobody outside is asked anything.
"""

import logging
import socket
import sys
from collections.abc import AsyncIterator, Sequence
from contextlib import asynccontextmanager
from ipaddress import ip_address
from urllib.parse import SplitResult, urlsplit

import streamlit as st
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware import Middleware
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from streamlit.web.server import server_util

HERE = frozenset({"localhost", "127.0.0.1", "::1"})
EVERYWHERE = frozenset({"0.0.0.0", "::", ""})  # noqa: S104 - what a server may listen on, not ours
READING = frozenset({"GET", "HEAD", "OPTIONS"})
DEFAULT_PORTS = {"http": 80, "https": 443}
MISDIRECTED, FORBIDDEN, POLICY_VIOLATION = 421, 403, 1008
MOST_LOGGED = 100
SAID_TO_BROWSERS = {
    # no other site puts a page of ours into a frame of its own and has it clicked
    "X-Frame-Options": "SAMEORIGIN",
    "Content-Security-Policy": "frame-ancestors 'self'",
    "X-Content-Type-Options": "nosniff",
    # whoever has a run's link can open the run: no other site is told it
    "Referrer-Policy": "same-origin",
}

log = logging.getLogger(__name__)


class OwnPagesOnly:
    """ASGI middleware: refuses other sites' pages and names that are not the server's."""

    def __init__(self, app: ASGIApp) -> None:
        self.app = app
        self._logged: set[str] = set()

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer one request or handshake, or hand it on."""
        if scope["type"] not in {"http", "websocket"}:
            await self.app(scope, receive, send)
            return
        headers = Headers(scope=scope)
        host, origins = headers.get("host", ""), headers.getlist("origin")
        changes = scope["type"] == "websocket" or scope["method"] not in READING
        if not is_own_name(host):
            await self._refuse(scope, receive, send, MISDIRECTED, not_our_name(host))
        elif changes and not all(is_own_page(o, host) or is_listed(o) for o in origins):
            await self._refuse(scope, receive, send, FORBIDDEN, not_our_page(origins, host))
        else:
            if changes:
                _settle_origin(scope, host, origins)
            await self.app(scope, receive, _with_headers(send))

    async def _refuse(
        self, scope: Scope, receive: Receive, send: Send, status: int, why: str
    ) -> None:
        if why not in self._logged and len(self._logged) < MOST_LOGGED:
            self._logged.add(why)
            log.warning("%s", why)
        if scope["type"] == "websocket":
            await receive()  # the handshake, which is answered with a 403
            await send({"type": "websocket.close", "code": POLICY_VIOLATION, "reason": ""})
        else:
            answer = PlainTextResponse(f"{why}\n", status_code=status)
            await answer(scope, receive, _with_headers(send))


MIDDLEWARE = [Middleware(OwnPagesOnly)]
"""Before all of Streamlit's own."""


def is_own_name(host: str) -> bool:
    """Whether a `Host` header is a name of this server.

    Those of Streamlit's option `server.allowedHosts`, if given. Else, listening on this machine
    only, this machine; listening more widely, any address in numbers and this machine's name,
    which no other site can take on.
    """
    name = _name(host)
    if name is None:
        return False
    listed = [each.strip().lower().rstrip(".") for each in st.get_option("server.allowedHosts")]
    if listed:
        below = [each[1:] for each in listed if each.startswith("*.")]
        return "*" in listed or name in listed or name.endswith(tuple(below))
    address = (st.get_option("server.address") or "").lower()
    if name in HERE or name == address:
        return True
    if address in HERE:
        return False
    machine = socket.gethostname().lower()
    own = {machine, f"{machine}.local", (st.get_option("browser.serverAddress") or "").lower()}
    return name in own or _is_numeric(name)


def is_own_page(origin: str, host: str) -> bool:
    """Whether an `Origin` is a page this server sent, by its name and its port."""
    parts = _split(origin)
    if parts is None or parts.scheme not in DEFAULT_PORTS or parts.hostname != _name(host):
        return False
    there = urlsplit(f"//{host}")
    usual = DEFAULT_PORTS[parts.scheme]
    return (parts.port or usual) == (there.port or usual)


def is_listed(origin: str) -> bool:
    """Whether an `Origin` is one of Streamlit's option `server.corsAllowedOrigins`."""
    return server_util.is_allowed_origin(origin)


def not_our_name(host: str) -> str:
    """Why a request for a name is refused, and what lets it in."""
    return (
        f"Refused: this server does not go by the name {host!r}. Whoever runs it can name it: "
        "--server.allowedHosts (docs/deploy.md)."
    )


def not_our_page(origins: Sequence[str], host: str) -> str:
    """Why a page's message is refused, and what lets it in."""
    return (
        f"Refused: a page of {', '.join(map(repr, origins))} spoke to {host!r}, and is none of "
        "this server's. A proxy has to pass on the Host as the browser gave it, port included; "
        "other sites are let in by --server.corsAllowedOrigins (docs/deploy.md)."
    )


def _settle_origin(scope: Scope, host: str, origins: Sequence[str]) -> None:
    """Say the same to Streamlit in words that it takes without asking anyone.

    An own page's `Origin` in exactly the form of the `Host`; a listed site's not at all, so that
    it is no visitor who has signed in here.
    """
    headers = MutableHeaders(scope=scope)
    if origins and all(is_own_page(origin, host) for origin in origins):
        headers["origin"] = f"{urlsplit(origins[0]).scheme}://{host}"
    else:
        del headers["origin"]


def _with_headers(send: Send) -> Send:
    async def told(message: Message) -> None:
        if message["type"] == "http.response.start":
            headers = MutableHeaders(scope=message)
            for name, value in SAID_TO_BROWSERS.items():
                headers.setdefault(name, value)
        await send(message)

    return told


def _split(url: str) -> SplitResult | None:
    """The parts of an address, or None where it is none."""
    try:
        parts = urlsplit(url)
        _ = parts.port  # raises where it is no number
    except ValueError:
        return None
    return parts


def _name(host: str) -> str | None:
    """The name in a `Host` header, without its port; None where it is more, or less, than that."""
    parts = _split(f"//{host}")
    if parts is None or parts.netloc != host or parts.username is not None or not parts.hostname:
        return None
    return parts.hostname.rstrip(".")


def _is_numeric(name: str) -> bool:
    try:
        ip_address(name)
    except ValueError:
        return False
    return True


@asynccontextmanager
async def say_where(_: object) -> AsyncIterator[None]:
    """Lifespan that tells on the terminal where the pages are: Streamlit would ask outside."""
    address, named = st.get_option("server.address") or "", st.get_option("browser.serverAddress")
    names = [address] if address not in EVERYWHERE else ["localhost", socket.gethostname()]
    if named != "localhost":
        names = [named]
    urls = "".join(f"    {server_util.get_url(name)}\n" for name in names)
    sys.stdout.write(f"\n  evdash is open in the browser at\n\n{urls}\n")
    sys.stdout.flush()
    yield
