"""Hostile texts are shown as they are, nothing is fetched from elsewhere, nothing calls home."""

import json
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Browser, Page

from evdash.domain.trace import Trace
from evdash.horizon.day import start_day, step
from evdash.scheduling.p1 import p1_policy
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Store
from evdash.ui.words import JOINER
from tests.browser.conftest import ROOT, serving, visiting
from tests.browser.live import SETTLED
from tests.builders import OPTIONS, line, make_scenario, node, vehicle

PAGES = ("", "vehicles", "feeder", "model", "scenario", "compare", "studies")
ELSEWHERE = "203.0.113.9"
"""An address of nobody's, kept for documentation."""
HOSTILE = (
    f"<b class=evil>![i](//{ELSEWHERE}/i)",
    "<img class=evil src=x onerror=evil=1>",
    f"[l](//{ELSEWHERE}) $evil^2$ :red[evil]",
    f"<a class=evil href=//{ELSEWHERE}>|</a>",
)
WATCH = """
import json, os, sys
def heard(event, arguments):
    if event in ("began", "socket.connect", "socket.sendto", "socket.getaddrinfo"):
        where = arguments[1] if event.startswith("socket.c") else arguments[0]
        with open(os.environ["EVDASH_HEARD"], "a") as file:
            file.write(json.dumps([event, repr(where)]) + "\\n")
sys.addaudithook(heard)
heard("began", ["127.0.0.1"])
"""
OWN = ("127.0.0.1", "localhost", "::1")


def hostile_day() -> Trace:
    """A day in which every text that is a person's own is hostile, in mid-run, with an event."""
    a, b, c, d = (f"n{text}" for text in HOSTILE)
    options = [
        option | {"name": f"{option['name']}{text}"}
        for option, text in zip(OPTIONS, HOSTILE, strict=False)
    ]
    vehicles = [
        vehicle(f"V{n}{text}", n / 4, 12, option=options[n % 2]["name"])
        for n, text in enumerate(HOSTILE * 3)
    ]
    trace = start_day(
        make_scenario(
            name=" ".join(HOSTILE),
            nodes=[node("s"), node(a, load_kw=40), node(b), node(c), node(d)],
            lines=[line("s", a, rating=90.0), line(a, b), line(a, c), line(c, d)],
            station={"node": b},
            options=options,
            vehicles=vehicles,
            events=[
                {"interval": 1, "event": "rating", "subject": f"line:s-{a}", "value": 80},
                {"interval": 1, "event": "no_show", "subject": vehicles[0]["vehicle"]},
            ],
        )
    )
    for _ in range(3):
        trace = step(trace, p1_policy())
    return trace


@pytest.fixture(scope="module")
def heard(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the server writes down whom it speaks to."""
    return tmp_path_factory.mktemp("heard") / "heard.jsonl"


@pytest.fixture(scope="module")
def stranger(heard: Path, tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str]]:
    """The address of a server that is listened to, and the link of the hostile day on it."""
    place = tmp_path_factory.mktemp("hook")
    (place / "sitecustomize.py").write_text(WATCH, encoding="utf-8")
    store = tmp_path_factory.mktemp("store")
    trace = hostile_day()
    journal = Journal(Store(store))
    journal.keep(Kept("", trace.inputs.given, trace))
    journal.store.database.close()
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PYTHONPATH", str(place))
        patch.setenv("EVDASH_HEARD", str(heard))
        with serving(str(store)) as address:
            yield address, journal.link


def visit(page: Page, address: str) -> list[str]:
    """Open a page and wait for it; every address it asked."""
    asked: list[str] = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto(address)
    for _ in range(4):
        page.wait_for_selector(SETTLED, timeout=60_000)
        page.wait_for_timeout(300)
    return asked


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path or "live")
def test_hostile_texts_stay_texts_and_nothing_comes_from_elsewhere(
    browser: Browser, stranger: tuple[str, str], path: str
) -> None:
    address, link = stranger
    with visiting(browser) as page:
        asked = visit(page, f"{address}/{path}?run={link}")
        strange = [
            url
            for url in asked
            if urlsplit(url).hostname not in OWN and not url.startswith("data:")
        ]
        strange = [url for url in strange if not url.startswith("blob:")]
        assert strange == []
        assert len(asked) > 5
        assert page.locator(".evil").count() == 0
        assert page.evaluate("typeof window.evil") == "undefined"
        links = page.locator(f'[href*="{ELSEWHERE}"], [src*="{ELSEWHERE}"]')
        assert links.count() == 0
        formulas = page.locator("annotation").all_text_contents()
        assert "evil^2" not in [formula.strip() for formula in formulas]
        if path in ("", "vehicles"):
            assert page.get_by_text("evil").count() > 0  # it is there, and as text


def test_the_server_speaks_to_nobody(
    browser: Browser, stranger: tuple[str, str], heard: Path
) -> None:
    """Neither when it starts nor when a day is stepped and its AC check is made."""
    address, _ = stranger
    with visiting(browser) as page:
        visit(page, address)
        for _ in range(2):
            page.locator(".st-key-step button").first.click()
            page.wait_for_timeout(500)
            page.wait_for_selector(SETTLED, timeout=60_000)
        page.wait_for_timeout(1500)
    said = [json.loads(row) for row in heard.read_text(encoding="utf-8").splitlines()]
    told = [f"{event} {where}" for event, where in said]
    assert any(one.startswith("began") for one in told)
    assert [one for one in told if not any(own in one for own in OWN)] == []


TURNED = (
    f"see http://{ELSEWHERE}/a?b or www.evil.example, a@evil.example",
    "code    in a line, :smile: :material/home: :streamlit:",
    "A -> B <-> C <- D -- E >= F <= G ~= H",
    "# no head, - no list, 1. no list, > no quote, $x^2$ and `code`",
)
"""What Streamlit's Markdown makes of texts even where every sign in them is escaped."""
MADE = "a, img, code, h1, li, blockquote, .katex"
SHOW = """
import streamlit as st
from evdash.ui.words import plain
from tests.browser.test_strangers import TURNED
for n, text in enumerate(TURNED):
    with st.container(key=f"text_{n}"):
        st.markdown(plain(text))
        st.button(plain(text), key=f"button_{n}")
"""


def test_texts_that_markdown_turns_into_others_stay_as_they_are(
    browser: Browser, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    (tmp_path / "show.py").write_text(SHOW, encoding="utf-8")
    with serving(app=tmp_path / "show.py") as address, visiting(browser) as page:
        page.goto(address)
        page.wait_for_selector(SETTLED, timeout=60_000)
        for n, text in enumerate(TURNED):
            box = page.locator(f".st-key-text_{n}")
            for shown in (box.locator("p").first, box.locator("button")):
                told = shown.inner_text().replace(JOINER, "")
                assert " ".join(told.split()) == " ".join(text.split())
            made = box.locator(
                "a, img, code, h1, li, blockquote, .katex, [data-testid=stIconMaterial]"
            )
            assert made.count() == 0
