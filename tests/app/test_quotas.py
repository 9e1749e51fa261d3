"""How much one visitor may hold of a server: pages, uploads, races; by rule, and on a real one."""

import asyncio
import gc
import http.client
import sqlite3
import subprocess
import sys
import time
import uuid
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from starlette.types import Message, Receive, Scope, Send
from streamlit.proto.Common_pb2 import FileUploaderState, UploadedFileInfo
from streamlit.proto.WidgetStates_pb2 import WidgetState, WidgetStates

from benchmarks.crowd.server import Server, serving
from benchmarks.crowd.visitor import Visitor
from evdash.domain.quotas import MB, TABS, UPLOADED_BYTES, WAITING_RACES, Quota, QuotaReached
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.inputs import prepare
from evdash.ui import gate
from evdash.ui.gate import Uploads, WithinQuotas
from evdash.ui.race.line import Line
from evdash.ui.race.racing import Racing
from evdash.ui.visitors import visitor_at

FILES, FILE_BYTES = 40, 9 * MB
OUTSIDE = ("203.0.113.7", "203.0.113.8")


@pytest.mark.parametrize(
    ("one", "other", "same"),
    [
        (OUTSIDE[0], OUTSIDE[0], True),
        (OUTSIDE[0], OUTSIDE[1], False),
        ("2001:db8::1", "2001:db8::ffff:1", True),  # one house has many of these
        ("2001:db8::1", "2001:db8:0:1::1", False),
        ("::ffff:203.0.113.7", OUTSIDE[0], True),
        ("fe80::1%eth0", "fe80::1", True),
    ],
)
def test_visitors_are_told_apart_by_where_they_come_from(one: str, other: str, same: bool) -> None:
    found = visitor_at(one)
    assert found is not None
    assert one not in found
    assert (found == visitor_at(other)) is same


@pytest.mark.parametrize("host", ["127.0.0.1", "::1", "::ffff:127.0.0.1", "", None, "testclient"])
def test_who_sits_at_the_server_is_nobody_in_particular(host: str | None) -> None:
    assert visitor_at(host) is None


def answered(middleware: WithinQuotas, scope: Scope, body: bytes = b"") -> list[Message]:
    sent: list[Message] = []

    async def receive() -> Message:
        return {"type": "http.request", "body": body, "more_body": False}

    async def send(message: Message) -> None:
        sent.append(message)

    asyncio.run(middleware(scope, receive, send))
    return sent


def handshake(host: str) -> Scope:
    return {"type": "websocket", "path": "/_stcore/stream", "headers": [], "client": (host, 1)}


def page(host: str) -> Scope:
    return handshake(host) | {"type": "http", "method": "GET", "path": "/compare"}


async def _accept(scope: Scope, receive: Receive, send: Send) -> None:
    await send({"type": "accepted"})


def test_pages_are_bounded_for_one_address_and_in_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gate, "TABS", Quota(3, 5, TABS.told_each, TABS.told_total))
    told: list[bytes] = []

    async def everything() -> None:
        leave = asyncio.Event()

        async def stay(scope: Scope, receive: Receive, send: Send) -> None:
            if scope["type"] == "websocket":
                await leave.wait()
            await send({"type": "accepted"})

        middleware = WithinQuotas(stay)

        async def ask(scope: Scope) -> None:
            async def receive() -> Message:
                return {"type": "websocket.connect"}

            async def send(message: Message) -> None:
                told.append(message.get("body", message["type"].encode()))

            await middleware(scope, receive, send)

        hosts = [OUTSIDE[0]] * 3 + ["127.0.0.1"]
        tabs = [asyncio.create_task(ask(handshake(host))) for host in hosts]
        await asyncio.sleep(0)
        await ask(handshake(OUTSIDE[0]))
        assert told.pop() == b"websocket.close"
        await ask(page(OUTSIDE[0]))
        assert told.pop().decode().strip() == TABS.told_each
        await ask(page(OUTSIDE[1]))
        assert told.pop() == b"accepted"
        tabs.append(asyncio.create_task(ask(handshake(OUTSIDE[1]))))
        await asyncio.sleep(0)
        await ask(page("127.0.0.1"))
        assert told.pop().decode().strip() == TABS.told_total
        leave.set()
        await asyncio.gather(*tabs)
        assert told[-5:] == [b"accepted"] * 5
        await ask(handshake(OUTSIDE[0]))  # the others have gone
        assert told.pop() == b"accepted"

    asyncio.run(everything())


def test_uploads_are_bounded_for_one_visitor_and_in_all() -> None:
    kept: dict[str, int] = {"a": 30 * MB}
    uploads = Uploads(lambda: kept)
    uploads.begin("a", "one", 10 * MB)
    with pytest.raises(QuotaReached, match="a few at a time"):
        uploads.begin("a", "one", 1)
    assert "a few at a time" in uploads.told("a")
    assert uploads.told("a") == ""
    with pytest.raises(QuotaReached):  # another tab of the same visitor
        uploads.begin("b", "one", 1)
    uploads.begin("c", "two", 10 * MB)
    uploads.end("a", 10 * MB)
    uploads.begin("b", "one", 10 * MB)
    kept |= {f"{n}": 36 * MB for n in range(4)}
    with pytest.raises(QuotaReached, match="This server"):
        uploads.begin("d", None, 10 * MB)
    kept.clear()
    uploads.begin("d", None, 10 * MB)


def test_a_refused_upload_is_answered_in_words(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gate, "uploads", Uploads(lambda: {"session": UPLOADED_BYTES.each}))
    scope = page(OUTSIDE[0]) | {"method": "PUT", "path": "/_stcore/upload_file/session/file"}
    start, body = answered(WithinQuotas(_accept), scope, b"x" * 100)
    assert start["status"] == 200  # an error would never reach the page
    assert body["body"].decode().strip() == UPLOADED_BYTES.told_each
    assert answered(WithinQuotas(_accept), scope | {"path": "/x/_stcore/health"})


def put(server: Server, session: str, name: str) -> tuple[int, str]:
    """Bring one file to a real server as a browser does; the status and what is said."""
    head = (
        f'--x\r\nContent-Disposition: form-data; name="file"; filename="{name}.csv"\r\n'
        "Content-Type: text/csv\r\n\r\n"
    )
    body = head.encode() + b"x" * FILE_BYTES + b"\r\n--x--\r\n"
    connection = http.client.HTTPConnection(urlsplit(server.address).netloc, timeout=60)
    path = f"/_stcore/upload_file/{session}/{name}"
    connection.request("PUT", path, body, {"Content-Type": "multipart/form-data; boundary=x"})
    answer = connection.getresponse()
    said = answer.read().decode()
    connection.close()
    return answer.status, said


async def brought(visitor: Visitor, names: list[str]) -> None:
    """Tell the page that files have come, as the browser does."""
    widget = next(one for key, one in visitor.widgets.items() if key.startswith("scenario_upload"))
    infos = [UploadedFileInfo(file_id=name, name="a.csv", size=FILE_BYTES) for name in names]
    state = WidgetState(id=widget)
    state.file_uploader_state_value.CopyFrom(FileUploaderState(uploaded_file_info=infos))
    await visitor._ask(WidgetStates(widgets=[state]))
    await visitor.settled()


async def uploading(server: Server) -> None:
    visitor = Visitor(server.address)
    await visitor.open()
    await visitor.turn_to("scenario")
    before = server.memory_mb
    for files in (FILES, 6):  # what was refused by the page makes room for as much again
        visitor.widgets.clear()
        await visitor.turn_to("scenario")
        names = [f"{uuid.uuid4()}" for _ in range(files)]
        answers = [await asyncio.to_thread(put, server, visitor.session, name) for name in names]
        taken = [name for name, (status, _) in zip(names, answers, strict=True) if status == 204]
        assert len(taken) == UPLOADED_BYTES.each // (FILE_BYTES + 200)
        assert {said.strip() for status, said in answers if status != 204} == {
            UPLOADED_BYTES.told_each
        }
        await brought(visitor, names)
        told = " ".join(visitor.texts())
        assert "Nothing was taken in" in told
        lost = f"{files - len(taken)} of {files} files were not kept. {UPLOADED_BYTES.told_each}"
        assert lost in told
    assert server.memory_mb - before < 3 * UPLOADED_BYTES.each / MB
    assert visitor.exceptions == []
    await visitor.close()


def test_forty_files_from_one_tab_leave_a_real_server_its_memory(tmp_path: Path) -> None:
    options = "--server.enableXsrfProtection=false"
    with serving(tmp_path, options) as server, ThreadPoolExecutor(1) as thread:
        thread.submit(asyncio.run, uploading(server)).result()


async def stepping(server: Server, addresses: list[str]) -> None:
    for address in addresses:
        told = {"X-Forwarded-For": address} if address else {}
        visitor = Visitor(server.address, told)
        await visitor.open()
        await visitor.press("step")
        await visitor.close()


def test_a_proxy_on_this_machine_says_whom_it_speaks_for(tmp_path: Path) -> None:
    with serving(tmp_path) as server, ThreadPoolExecutor(1) as thread:
        addresses = [OUTSIDE[0], OUTSIDE[1], OUTSIDE[0], ""]
        thread.submit(asyncio.run, stepping(server, addresses)).result()
    with sqlite3.connect(tmp_path / "runs.sqlite3") as data:
        runs = data.execute("SELECT count(*) FROM runs").fetchone()[0]
        visitors = [who for (who,) in data.execute("SELECT visitor FROM begun_by")]
        dump = " ".join(data.iterdump())
    assert runs == 4
    assert sorted(map(visitors.count, visitors)) == [1, 2, 2]
    assert not any(address in dump for address in OUTSIDE)


def racing_processes(server: Server) -> int:
    """Processes that race for a server, found by the system."""
    listing = subprocess.run(
        ["ps", "--ppid", f"{server.process.pid}", "-o", "args="],
        capture_output=True,
        text=True,
        check=False,  # 1 where there are none
    )
    return sum("evdash.ui.race.work" in line for line in listing.stdout.splitlines())


async def racing(server: Server, number: int) -> tuple[list[int], list[str]]:
    visitors = [Visitor(server.address) for _ in range(number)]
    for visitor in visitors:
        await visitor.open()
        await visitor.turn_to("compare")
        await visitor.press("race_start")
    counts = []
    for _ in range(10):
        counts.append(await asyncio.to_thread(racing_processes, server))
        await asyncio.sleep(0.2)
    told = [" ".join(visitor.texts()) for visitor in visitors]
    for visitor in visitors[::-1]:
        await visitor.press("race_stop")
        await visitor.close()
    return counts, told


def test_races_that_wait_hold_no_process_of_a_real_server(tmp_path: Path) -> None:
    with serving(tmp_path) as server, ThreadPoolExecutor(1) as thread:
        counts, told = thread.submit(asyncio.run, racing(server, 4)).result()
        assert max(counts) == 1
        assert sum("Waiting for the race that is on" in one for one in told) == 3
        assert "2 more that wait" in told[3]
        assert racing_processes(server) == 0


def sleeper() -> "subprocess.Popen[bytes]":
    return subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)"])


def test_races_that_wait_are_bounded_and_take_turns() -> None:
    line = Line()
    first = line.join("one", sleeper)
    until = time.monotonic() + 60
    while first.process is None and time.monotonic() < until:
        time.sleep(0.01)
    waiting = [line.join("one", sleeper) for _ in range(WAITING_RACES.each)]
    with pytest.raises(QuotaReached, match="Stop one of them"):
        line.join("one", sleeper)
    waiting += [line.join(None, sleeper) for _ in range(WAITING_RACES.total - len(waiting))]
    with pytest.raises(QuotaReached, match="20 races are waiting"):
        line.join("two", sleeper)
    assert [place.process for place in waiting] == [None] * WAITING_RACES.total
    assert [line.ahead_of(place) for place in waiting[:3]] == [0, 1, 2]
    line.leave(waiting.pop(0))
    line.leave(first)
    while waiting[0].process is None and time.monotonic() < until:
        time.sleep(0.01)
    assert waiting[0].process is not None
    for place in waiting[::-1]:
        line.leave(place)
    assert waiting[0].process.poll() is not None


def test_a_race_goes_with_its_tab_and_a_refused_one_is_told(monkeypatch) -> None:
    line = Line()
    monkeypatch.setattr("evdash.ui.race.racing.line", line)
    monkeypatch.setattr("evdash.ui.race.racing._begun", lambda command: sleeper())
    inputs = prepare(read_scenario(DEFAULT))
    tabs = [Racing() for _ in range(1 + WAITING_RACES.total)]
    for tab in tabs:
        tab.start(inputs, ["p1"])
        until = time.monotonic() + 60
        while tabs[0].is_in_line and time.monotonic() < until:
            time.sleep(0.01)
    late = Racing()
    late.start(inputs, ["p1"])
    assert late.said == WAITING_RACES.told_total
    assert not late.is_running
    first = tabs[0]._place
    assert first is not None
    assert first.process is not None
    del tab
    tabs.reverse()
    while tabs:
        tabs.pop(0)
    gc.collect()
    assert first.process.poll() is not None
    assert not line._waiting
