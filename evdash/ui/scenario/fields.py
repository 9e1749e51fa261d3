"""One widget for one key of scenario.toml, labelled and explained by the key's declaration."""

from collections.abc import Sequence
from typing import Any

import streamlit as st
from pydantic.fields import FieldInfo

from evdash.files.overrides import parse_setting
from evdash.files.wording import allowed_words
from evdash.ui.scenario.editor import Editor
from evdash.ui.settings import unit_of

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


def synced(editor: Editor, name: str, value: object) -> tuple[str, Any]:
    """The key of a widget and what was typed into it since it was last shown, else MISSING.

    Afterwards the widget shows `value`, or what was typed if the caller lays that over the draft.
    """
    key = f"scenario:{name}"
    typed = st.session_state.get(key, MISSING)
    is_edit = typed is not MISSING and key in editor.shown and typed != editor.shown[key]
    truth = typed if is_edit else value
    if typed is MISSING or typed != truth:
        st.session_state[key] = truth
    editor.shown[key] = truth
    return key, typed if is_edit else MISSING


def number(editor: Editor, path: tuple[str, ...], field: FieldInfo, *, whole: bool = False) -> None:
    """A number; as text where what stands there is none."""
    value = editor.get(path)
    is_number = isinstance(value, int | float) and not isinstance(value, bool)
    if not is_number and value is not None:
        _as_text(editor, path, field, value)
        return
    kind = int if whole else float
    if whole and isinstance(value, float) and not value.is_integer():
        _as_text(editor, path, field, value)
        return
    key, typed = synced(editor, ".".join(path), None if value is None else kind(value))
    if typed is not MISSING:
        editor.set(path, typed)
    st.number_input(
        label_of(field),
        value=None,
        step=kind(1) if whole else _step(field, value),
        format="%d" if whole else "%g",
        key=key,
        help=help_of(field, ".".join(path)),
    )


def _step(field: FieldInfo, value: object) -> float:
    """A step that suits the value: hundredths where it is a share, a price or a voltage."""
    size = abs(float(value)) if isinstance(value, int | float) else 0.0
    return 0.01 if size < 2 else 0.1 if size < 20 else 1.0


def _as_text(editor: Editor, path: tuple[str, ...], field: FieldInfo, value: object) -> None:
    dotted = ".".join(path)
    key, typed = synced(editor, f"{dotted}:text", str(value))
    if typed is not MISSING:
        editor.set(path, parse_setting(f"{dotted}={typed}").value)
    st.text_input(label_of(field), key=key, help=help_of(field, dotted))


def text(editor: Editor, path: tuple[str, ...], field: FieldInfo) -> None:
    """A text; a moment as YYYY-MM-DDTHH:MM."""
    value = editor.get(path)
    shown = value.strftime("%Y-%m-%dT%H:%M") if hasattr(value, "strftime") else value
    key, typed = synced(editor, ".".join(path), "" if shown is None else str(shown))
    if typed is not MISSING:
        editor.set(path, typed)
    st.text_input(label_of(field), key=key, help=help_of(field, ".".join(path)))


def choice(editor: Editor, path: tuple[str, ...], field: FieldInfo, options: Sequence[str]) -> None:
    """One of the names there are, or another one typed."""
    value = str(editor.get(path) or "")
    key, typed = synced(editor, ".".join(path), value)
    if typed is not MISSING:
        editor.set(path, typed or "")
    now = str(st.session_state[key] or "")
    st.selectbox(
        label_of(field),
        list(dict.fromkeys([*options, *([now] if now else [])])),
        key=key,
        accept_new_options=True,
        help=help_of(field, ".".join(path)),
    )


def pair(editor: Editor, path: tuple[str, ...], field: FieldInfo, names: tuple[str, str]) -> None:
    """A list of two numbers; as text where it is none."""
    value = editor.get(path)
    dotted = ".".join(path)
    numbers = isinstance(value, list) and all(isinstance(part, int | float) for part in value)
    if not numbers or len(value) != 2:
        _as_text(editor, path, field, value)
        return
    for column, place, name in zip(st.columns(2), (0, 1), names, strict=True):
        key, typed = synced(editor, f"{dotted}.{place}", float(value[place]))
        if typed is not MISSING and typed is not None:
            value = [*value[:place], typed, *value[place + 1 :]]
            editor.set(path, value)
        with column:
            st.number_input(
                f"{label_of(field).partition(',')[0]}: {name}",
                step=0.01,
                format="%g",
                key=key,
                help=f"{label_of(field)}. {help_of(field, dotted)}",
            )
