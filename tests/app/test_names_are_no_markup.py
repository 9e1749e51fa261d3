"""No name is ever markup: not in what Streamlit reads as Markdown, labels and help among it."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from google.protobuf.message import Message
from hypothesis import example, given
from hypothesis import strategies as st
from streamlit.testing.v1 import AppTest

from evdash.ui.run import Run
from evdash.ui.session import KEY
from evdash.ui.words import JOINER, plain
from tests.browser.test_strangers import HOSTILE, hostile_day

ROOT = Path(__file__).parents[2]
PAGES = [path.stem for path in sorted((ROOT / "pages").glob("*.py"))]
AS_MARKDOWN = {
    "label", "body", "help", "text", "delta", "title", "caption", "captions",
    "content_help", "tooltip", "options",
}  # fmt: skip
PLAIN = {
    ("Text", "body"),  # st.text
    ("Selectbox", "options"),
    ("MultiSelect", "options"),
    ("Slider", "options"),
    ("Code", "body"),
}
"""What Streamlit shows as it is."""
RAW = re.compile(r"(?<!\\)(!\[i|<img class|\[l\]|:red\[|<a class|<b class)")
"""What would be images, links and colours as it is not escaped."""


def strings(message: Message, kind: str = "") -> Iterator[tuple[str, str, str]]:
    """Every text in a message: the kind of element, the field, the text."""
    for field, value in message.ListFields():
        inside = value if field.is_repeated else [value]
        for each in inside if not hasattr(inside, "items") else inside.values():
            if isinstance(each, str):
                yield kind or message.DESCRIPTOR.name, field.name, each
            elif isinstance(each, Message):
                yield from strings(each, each.DESCRIPTOR.name)


def elements(block: Any) -> Iterator[Message]:
    for child in block.children.values():
        if getattr(child, "proto", None) is not None:
            yield child.proto
        if hasattr(child, "children"):
            yield from elements(child)


def as_markdown(at: AppTest) -> list[tuple[str, str, str]]:
    return [
        (kind, field, text)
        for proto in elements(at._tree)
        for kind, field, text in strings(proto)
        if field in AS_MARKDOWN and (kind, field) not in PLAIN
    ]


@pytest.mark.parametrize("page", PAGES)
def test_hostile_names_are_escaped_wherever_markdown_is_read(page: str) -> None:
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    at.run()
    trace = hostile_day()
    at.session_state[KEY].take(Run(None, trace.scenario, trace))
    at.switch_page(f"pages/{page}.py").run()
    assert not at.exception
    read = as_markdown(at)
    assert len(read) > 10
    assert [each for each in read if RAW.search(each[2])] == []
    assert any("evil" in text for _, _, text in read) or page in (
        "scenario",
        "compare",
    )  # in fields; once pinned


def asking(name: str) -> None:
    from evdash.domain.study import Axis, Band
    from evdash.ui.studies.ask import _values
    from evdash.ui.studies.pictures import Dimension, _chosen

    _values("own", 0, Axis(name=name, key="station.chargers", values=(1, 2)), [])
    varied = [Dimension(place, name, (name, "b")) for place in range(3)]
    _chosen([Band((name,) * 3, "profit", 1, *[1.0] * 5)], varied)


@pytest.mark.parametrize("text", HOSTILE)
def test_lines_of_a_study_are_no_markup(text: str) -> None:
    """What varies may be called anything; its name stands in labels."""
    at = AppTest.from_function(asking, default_timeout=60, args=(f"n{text}"[:60],)).run()
    assert not at.exception
    read = as_markdown(at)
    assert sum("evil" in each[2] or "203" in each[2] for each in read) >= 2
    assert [each for each in read if RAW.search(each[2])] == []


@given(st.text())
@example("a\n\n    code\n- list\n# head")
@example("see http://x.example/a?b, www.x.example or a@x.example")
@example(":smile: :material/home: :streamlit: :red[x] A -> B <-> C -- D >= E <= F ~= G")
def test_plain_text_is_the_same_text_in_one_line(text: str) -> None:
    said = plain(text)
    assert "\n" not in said
    unescaped = re.sub(r"\\(.)", r"\1", said)
    assert unescaped.replace(JOINER, "") == " ".join(text.split()).replace(JOINER, "")
