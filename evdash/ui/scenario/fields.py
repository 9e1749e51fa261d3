"""One widget for one key of scenario.toml, labelled and explained by the key's declaration."""

from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import streamlit as st
from pydantic.fields import FieldInfo

from evdash.errors import Fault
from evdash.files.numbers import number_rule, number_text, read_number
from evdash.files.overrides import parse_setting
from evdash.files.wording import allowed_words, shown
from evdash.ui.scenario.editor import Editor
from evdash.ui.settings import unit_of
from evdash.ui.typed import refuse

MISSING = object()


def label_of(field: FieldInfo) -> str:
    """The declared meaning and unit as a label."""
    unit = unit_of(field)
    told = str(field.description)
    return f"{told}, {unit}" if unit and unit not in told.lower() else told


def help_of(field: FieldInfo, key: str) -> str:
    """What is allowed, and the key's name in scenario.toml."""
    allowed = allowed_words(field)
    return f"{f'Allowed: {allowed}. ' if allowed else ''}In scenario.toml: `{key}`."


def bound(editor: Editor, name: str, value: object, lay: Callable[[Any], None]) -> str:
    """The key of a widget that shows `value`; what is typed into it will be handed to `lay`."""
    key = f"scenario:{name}"
    if st.session_state.get(key, MISSING) != value:
        st.session_state[key] = value
    editor.shown[key] = value
    editor.laid[key] = lay
    return key


def number(editor: Editor, path: tuple[str, ...], field: FieldInfo, *, whole: bool = False) -> None:
    """A number. What is typed and is none stands in the draft as it is, and is a fault of it."""
    dotted = ".".join(path)

    def lay(typed: str) -> None:
        editor.set(path, as_typed(typed, whole=whole))

    _number(editor, dotted, field, editor.get(path), lay, label=label_of(field), whole=whole)


def _number(
    editor: Editor,
    name: str,
    field: FieldInfo,
    value: object,
    lay: Callable[[str], None],
    *,
    label: str,
    whole: bool = False,
) -> None:
    key = bound(editor, name, text_of(value), lay)
    st.text_input(label, key=key, help=help_of(field, name))
    if isinstance(value, str):
        refuse(Fault(label, shown(value), number_rule(value, whole=whole)))


def as_typed(text: str, *, whole: bool = False) -> int | float | str | None:
    """What a cell or field of a number puts into a draft: the number, or else the text itself.

    None for nothing.
    """
    if not text.strip():
        return None
    try:
        return read_number(text, whole=whole)
    except ValueError:
        return text.strip()


def text_of(value: object) -> str:
    """A value of a draft as the text of a field or cell."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int | float):
        return number_text(value)
    return "" if value is None else str(value)


def _as_text(editor: Editor, path: tuple[str, ...], field: FieldInfo, value: object) -> None:
    dotted = ".".join(path)

    def lay(typed: str) -> None:
        editor.set(path, parse_setting(f"{dotted}={typed}").value)

    key = bound(editor, f"{dotted}:text", str(value), lay)
    st.text_input(label_of(field), key=key, help=help_of(field, dotted))


def text(editor: Editor, path: tuple[str, ...], field: FieldInfo) -> None:
    """A text; a moment as YYYY-MM-DDTHH:MM."""
    value = editor.get(path)
    told = value.strftime("%Y-%m-%dT%H:%M") if hasattr(value, "strftime") else value
    key = bound(editor, ".".join(path), text_of(told), partial(editor.set, path))
    st.text_input(label_of(field), key=key, help=help_of(field, ".".join(path)))


def choice(editor: Editor, path: tuple[str, ...], field: FieldInfo, options: Sequence[str]) -> None:
    """One of the names there are, or another one typed."""
    value = str(editor.get(path) or "")
    key = bound(editor, ".".join(path), value, lambda typed: editor.set(path, typed or ""))
    st.selectbox(
        label_of(field),
        list(dict.fromkeys([*options, *([value] if value else [])])),
        key=key,
        accept_new_options=True,
        help=help_of(field, ".".join(path)),
    )


def pair(editor: Editor, path: tuple[str, ...], field: FieldInfo, names: tuple[str, str]) -> None:
    """A list of two numbers; as text where it is none."""
    value = editor.get(path)
    if not isinstance(value, list) or len(value) != 2:
        _as_text(editor, path, field, value)
        return

    def lay(typed: str, place: int) -> None:
        now = list(editor.get(path))
        now[place] = as_typed(typed) if typed.strip() else ""
        editor.set(path, now)

    for column, place, name in zip(st.columns(2), (0, 1), names, strict=True):
        label = f"{label_of(field).partition(',')[0]}: {name}"
        with column:
            dotted = f"{'.'.join(path)}.{place}"
            _number(editor, dotted, field, value[place], partial(lay, place=place), label=label)
