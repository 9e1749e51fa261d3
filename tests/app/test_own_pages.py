"""Who may speak to the server, and that it asks nobody outside: by rule, and on a real server."""

import asyncio
import http.client
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from urllib.parse import urlsplit

import pytest
import streamlit as st
from starlette.datastructures import Headers
from starlette.types import Message, Receive, Scope, Send

from evdash.ui import own_pages
from evdash.ui.own_pages import OwnPagesOnly, is_own_name, is_own_page
from tests.browser.conftest import serving

HANDSHAKES = 300
EVERYWHERE = "0.0.0.0"  # noqa: S104 - as in a lecture room
OPTIONS = {
    "server.address": "localhost",
    "server.allowedHosts": [],
    "server.corsAllowedOrigins": [],
    "browser.serverAddress": "localhost",
}


@pytest.fixture
def options(monkeypatch: pytest.MonkeyPatch) -> dict[str, object]:
    """Streamlit's options, as a test sets them."""
    told = dict(OPTIONS)
    monkeypatch.setattr(st, "get_option", told.__getitem__)
    monkeypatch.setattr(
        own_pages.server_util, "allowlisted_origins", lambda: set(told["server.corsAllowedOrigins"])
    )
    return told


@pytest.mark.parametrize(
    ("address", "host", "own"),
    [
        ("localhost", "localhost:8501", True),
        ("localhost", "LOCALHOST", True),
        ("localhost", "localhost.:8501", True),
        ("localhost", "127.0.0.1:8501", True),
        ("localhost", "[::1]:8501", True),
        ("localhost", "192.168.1.7:8501", False),
        ("localhost", "evil.example:8501", False),
        ("localhost", "localhost.evil.example", False),
        ("localhost", "evil.example@localhost", False),
        ("localhost", "localhost/evil.example", False),
        ("localhost", "localhost:port", False),
        ("localhost", "localhost:8501#", False),
        ("localhost", "", False),
        ("localhost", ":8501", False),
        ("localhost", "[::1", False),
        (EVERYWHERE, "192.168.1.7:8501", True),
        (EVERYWHERE, "[fe80::1]:8501", True),
        (EVERYWHERE, "lecture-pc:8501", True),
        (EVERYWHERE, "lecture-pc.local", True),
        (EVERYWHERE, "lecture-pc.evil.example", False),
        (EVERYWHERE, "evil.example", False),
        ("evdash.example.org", "evdash.example.org", True),
    ],
)
def test_the_names_a_server_goes_by(
    options: dict[str, object], monkeypatch: pytest.MonkeyPatch, address: str, host: str, own: bool
) -> None:
    monkeypatch.setattr(socket, "gethostname", lambda: "Lecture-PC")
    options["server.address"] = address
    assert is_own_name(host) is own


@pytest.mark.parametrize(
    ("host", "own"),
    [
        ("evdash.example.org", True),
        ("EVDASH.example.org:443", True),
        ("a.b.example.net", True),
        ("example.net", False),
        ("badexample.net", False),
        ("localhost:8501", False),
    ],
)
def test_names_given_by_whoever_runs_the_server(
    options: dict[str, object], host: str, own: bool
) -> None:
    options["server.allowedHosts"] = [" Evdash.example.org. ", "*.example.net"]
    assert is_own_name(host) is own
    options["server.allowedHosts"] = ["*"]
    assert is_own_name(host)


@pytest.mark.parametrize(
    ("origin", "host", "own"),
    [
        ("http://localhost:8501", "localhost:8501", True),
        ("http://localhost", "localhost:80", True),
        ("https://evdash.example.org", "evdash.example.org", True),
        ("https://evdash.example.org", "evdash.example.org:443", True),
        ("https://evdash.example.org:8443", "evdash.example.org", False),
        ("http://localhost:3000", "localhost:8501", False),
        ("http://localhost", "localhost:8501", False),
        ("http://127.0.0.1:8501", "localhost:8501", False),
        ("http://localhost.evil.example:8501", "localhost:8501", False),
        ("http://localhost:8501@evil.example", "localhost:8501", False),
        ("http://localhost:x", "localhost:8501", False),
        ("file://", "localhost:8501", False),
        ("null", "localhost:8501", False),
        ("", "localhost:8501", False),
    ],
)
def test_pages_of_the_servers_own_by_name_and_port(origin: str, host: str, own: bool) -> None:
    assert is_own_page(origin, host) is own


def told_to_streamlit(origins: list[str], host: str) -> list[str] | None:
    """The `Origin` that a handshake is handed on with; None where it is refused."""
    heard: list[list[str]] = []
    sent: list[str] = []

    async def streamlit(scope: Scope, receive: Receive, send: Send) -> None:
        heard.append(Headers(scope=scope).getlist("origin"))

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def send(message: Message) -> None:
        sent.append(message["type"])

    named = [("host", host), *(("origin", origin) for origin in origins)]
    raw = [(name.encode(), value.encode()) for name, value in named]
    scope = {"type": "websocket", "path": "/_stcore/stream", "headers": raw}
    asyncio.run(OwnPagesOnly(streamlit)(scope, receive, send))
    assert sent == ([] if heard else ["websocket.close"])
    return heard[0] if heard else None


def test_streamlit_is_told_an_origin_it_need_not_look_up(options: dict[str, object]) -> None:
    """It compares texts; what differs from the Host in form alone it would ask about."""
    own, listed, foreign = (
        "https://evdash.example.org",
        "https://portal.example.org",
        "https://evil.example",
    )
    options["server.allowedHosts"] = ["evdash.example.org"]
    options["server.corsAllowedOrigins"] = [listed]
    host = "evdash.example.org:443"
    assert told_to_streamlit([own], host) == [f"{own}:443"]
    assert told_to_streamlit([], host) == []
    assert told_to_streamlit([listed], host) == []
    assert told_to_streamlit([own, listed], host) == []
    assert told_to_streamlit([foreign], host) is None
    assert told_to_streamlit([own, foreign], host) is None


@contextmanager
def outside(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[bytes]]:
    """Stands for all that is outside: takes every call, and answers none."""
    calls: list[bytes] = []
    held: list[socket.socket] = []
    with socket.create_server(("127.0.0.1", 0)) as listener:

        def listen() -> None:
            while True:
                try:
                    call, _ = listener.accept()
                except OSError:
                    return
                held.append(call)
                calls.append(call.recv(400))

        threading.Thread(target=listen, daemon=True).start()
        proxy = f"http://127.0.0.1:{listener.getsockname()[1]}"
        for name in ("HTTP_PROXY", "HTTPS_PROXY", "http_proxy", "https_proxy"):
            monkeypatch.setenv(name, proxy)
        for name in ("NO_PROXY", "no_proxy"):
            monkeypatch.setenv(name, "localhost,127.0.0.1")
        yield calls
    for call in held:
        call.close()


def shake_hands(address: str, origin: str, host: str | None = None) -> int:
    """Ask for a WebSocket as a page of `origin` does; the status of the answer."""
    place = urlsplit(address)
    connection = http.client.HTTPConnection(place.hostname or "", place.port, timeout=120)
    connection.putrequest("GET", "/_stcore/stream", skip_host=True)
    for name, value in {
        "Host": host or place.netloc,
        "Origin": origin,
        "Upgrade": "websocket",
        "Connection": "Upgrade",
        "Sec-WebSocket-Key": "dGhlIHNhbXBsZSBub25jZQ==",
        "Sec-WebSocket-Version": "13",
    }.items():
        connection.putheader(name, value)
    connection.endheaders()
    status = connection.getresponse().status
    connection.close()
    return status


@pytest.mark.parametrize("listens_on", ["127.0.0.1", EVERYWHERE])
def test_a_real_server_refuses_foreign_pages_and_asks_nobody(
    monkeypatch: pytest.MonkeyPatch, listens_on: str
) -> None:
    with (
        outside(monkeypatch) as calls,
        serving(options=[f"--server.address={listens_on}"]) as address,
    ):
        port = urlsplit(address).port
        foreign = [
            "http://evil.example",
            "http://127.0.0.1:1",
            f"http://localhost:{port}",
            "null",
            f"https://[::1]:{port}",
        ]
        for n in range(HANDSHAKES):
            assert shake_hands(address, foreign[n % len(foreign)]) == own_pages.FORBIDDEN
        rebound = f"evil.example:{port}"
        assert shake_hands(address, f"http://{rebound}", rebound) == own_pages.FORBIDDEN
        assert shake_hands(address, address) == http.HTTPStatus.SWITCHING_PROTOCOLS
        page = http.client.HTTPConnection("127.0.0.1", port or 0, timeout=120)
        page.request("GET", "/", headers={"Host": rebound})
        answer = page.getresponse()
        assert answer.status == own_pages.MISDIRECTED
        assert b"--server.allowedHosts" in answer.read()
        page.request("GET", "/vehicles")
        told = page.getresponse().headers
        assert {name: told[name] for name in own_pages.SAID_TO_BROWSERS} == (
            own_pages.SAID_TO_BROWSERS
        )
        page.close()
    assert calls == []
