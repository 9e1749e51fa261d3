"""A table of any columns on its way in: what it holds, what its columns mean, which days of it."""

from collections.abc import Callable, Mapping, Sequence
from datetime import date
from functools import partial
from typing import Any, TypeVar

import streamlit as st
from annotated_types import Ge, Le

from evdash.errors import Fault, InputError
from evdash.files.draft import Draft
from evdash.imports import profile_columns, session_columns
from evdash.imports.clock import Reading
from evdash.imports.profile import (
    MOST_DAYS as MOST_PROFILE_DAYS,
)
from evdash.imports.profile import (
    ProfileRules,
    first_day_for,
    with_profile,
)
from evdash.imports.session_rows import HOURS, SessionRules
from evdash.imports.sessions import MOST_DAYS, days_of, with_sessions
from evdash.imports.tables import ForeignTable
from evdash.ui.scenario.editor import Editor, Said
from evdash.ui.scenario.waiting import WaitingTable
from evdash.ui.typed import ask_number
from evdash.ui.words import counted, plain

Rules = TypeVar("Rules", SessionRules, ProfileRules)
Change = Callable[[Draft, ForeignTable], tuple[Draft, tuple[str, ...]]]
NONE = ""
SESSIONS, VALUES = "Recorded sessions", "Prices or loads by time"
ORDERS = {"as they say": None, "day first": True, "month first": False}
POWER_HELP = "pu: parts of the peak, as the scenario has them; kW and MW are divided by the peak."
EARLIEST, LATEST = date(1900, 1, 1), date(2999, 12, 31)


def table_form(editor: Editor) -> None:
    """What the waiting table holds; nothing is taken in before it is confirmed."""
    waiting = editor.waiting
    if waiting is None:
        return
    name, rows = plain(waiting.table.name), counted(len(waiting.table.rows), "row")
    if waiting.taken:
        with st.expander(f"{name}, {rows}: take in again, or other days of it"):
            _form(editor, waiting)
        return
    with st.container(border=True, key="table_form"):
        st.markdown(
            f"**{name}** has {rows}. Confirm what it holds and what its columns mean; nothing is "
            "taken in before."
        )
        _form(editor, waiting)


def _form(editor: Editor, waiting: WaitingTable) -> None:
    if len(waiting.tables) > 1:
        waiting.sheet = st.selectbox(
            "Sheet",
            list(waiting.tables),
            key=f"table:{waiting.number}:sheet",
            width=300,
            help="One sheet is taken in at a time.",
        )
    table = waiting.table
    guess = VALUES if profile_columns.looks_like_profile(table.columns) else SESSIONS
    st.dataframe(list(table.rows[:5]), hide_index=True, alt="The first rows of the table")
    holds = st.segmented_control(
        "It holds",
        [SESSIONS, VALUES],
        default=guess,
        required=True,
        key=f"{waiting.key}:holds",
        help="Sessions become the vehicles that arrive, a row each. Values become the energy "
        "price, the load or the generation of every interval.",
    )
    if holds == SESSIONS:
        rules = _session_rules(waiting)
        _buttons(editor, "Take the sessions in", "confirm_sessions", _confirm_sessions, rules)
    else:
        asked = _profile_rules(editor, waiting)
        _buttons(editor, "Take the values in", "confirm_profile", _confirm_profile, asked)


def _buttons(
    editor: Editor,
    label: str,
    key: str,
    confirm: Callable[[Editor, Rules], None],
    rules: Rules | tuple[Fault, ...],
) -> None:
    """Take the table in by `rules`, or say what is wrong with them; or leave it.

    Not in a callback, whose arguments would be those of the form as it was before the press.
    """
    with st.container(horizontal=True):
        pressed = st.button(
            label,
            key=key,
            type="primary",
            icon=":material/check:",
            help="What it replaces and how is told; Undo brings everything back. "
            "docs/importing.md says every rule.",
        )
        st.button("Leave it", on_click=_leave, args=(editor,), key="leave_table")
    if not pressed:
        return
    if isinstance(rules, tuple):
        editor.said = Said("Nothing was taken in; your work is as it was.", rules)
    else:
        confirm(editor, rules)
    st.rerun()


def _columns(
    waiting: WaitingTable,
    fields: Mapping[str, str],
    required: Sequence[str],
    guess: Mapping[str, str],
) -> dict[str, str]:
    """Which column each field is taken from, one select box each."""
    chosen: dict[str, str] = {}
    choices = [NONE, *waiting.table.columns]
    for place, (field, told) in enumerate(fields.items()):
        if place % 5 == 0:
            row = st.columns(5)
        with row[place % 5]:
            chosen[field] = st.selectbox(
                f"{field}{' (needed)' if field in required else ''}",
                choices,
                index=choices.index(guess.get(field, NONE)),
                format_func=lambda column: column or "–",
                key=f"{waiting.key}:{field}",
                help=told,
            )
    return chosen


def _reading(waiting: WaitingTable) -> Reading:
    """How times are to be read, in the two columns given."""
    zone, order = st.columns(2)
    with zone:
        named = st.text_input(
            "Time zone",
            key=f"{waiting.key}:zone",
            placeholder="Europe/Berlin",
            help="Where the station stands, such as America/Los_Angeles. Needed where times have "
            "an offset from UTC, or where clocks change. Blank: times count as they stand.",
        )
    with order:
        chosen = st.selectbox(
            "Dates like 3/4/2019",
            list(ORDERS),
            key=f"{waiting.key}:order",
            help="Where the table leaves open which is the day, it is a fault until you say so.",
        )
    return Reading(named.strip() or None, ORDERS[chosen])


def _session_rules(waiting: WaitingTable) -> SessionRules | tuple[Fault, ...]:
    table = waiting.table
    guess = session_columns.proposed(table.columns)
    columns = _columns(waiting, session_columns.FIELDS, session_columns.REQUIRED, guess)
    left, right = st.columns([2, 3])
    with left:
        reading = _reading(waiting)
    with right:
        unit, first, days = st.columns([1, 2, 1])
    with unit:
        duration = st.selectbox(
            "Durations in",
            list(HOURS),
            key=f"{waiting.key}:unit",
            help="Unit of a column that says how long a vehicle stays.",
        )
    rules = SessionRules(columns=columns, reading=reading, duration_unit=duration)
    with first:
        day = _day_of(waiting, rules)
    with days:
        count = ask_number(
            "Days",
            None if day is None else 1,
            f"{waiting.key}:days:{day}",
            (Ge(1), Le(MOST_DAYS)),
            f"How many days from the first on; blank: all, at most {MOST_DAYS}.",
            whole=True,
            blank=True,
        )
    if isinstance(count, Fault):
        return (count,)
    return SessionRules(
        columns=columns,
        reading=reading,
        duration_unit=duration,
        first_day=day,
        days=count,
    )


def _day_of(waiting: WaitingTable, rules: SessionRules) -> date | None:
    """The first day to replay, of those that have sessions; None for all."""
    key = (waiting.sheet, tuple(rules.columns.items()), rules.reading, rules.duration_unit)
    found = waiting.once(key, lambda: _days_if_readable(waiting.table, rules))
    return st.selectbox(
        "First day",
        [None, *found],
        format_func=lambda day: (
            "All days" if day is None else f"{day:%a, %d %b %Y} · {counted(found[day], 'session')}"
        ),
        key=f"{waiting.key}:first",
        help="All days are replayed one after the other, as one horizon. Or pick the first, and "
        "how many.",
    )


def _days_if_readable(table: ForeignTable, rules: SessionRules) -> dict[date, int]:
    try:
        return days_of(table, rules)
    except InputError:
        return {}  # every fault is told when the sessions are to be taken in


def _profile_rules(editor: Editor, waiting: WaitingTable) -> ProfileRules | tuple[Fault, ...]:
    table = waiting.table
    guess = profile_columns.proposed(table.columns)
    columns = _columns(waiting, profile_columns.FIELDS, profile_columns.REQUIRED, guess)
    units, peaks = _units(waiting, columns)
    left, right = st.columns([2, 3])
    with left:
        reading = _reading(waiting)
    with right:
        first, days, hold, end = st.columns([3, 2, 3, 3], vertical_alignment="bottom")
    with first:
        day: date | None = st.date_input(
            "First day",
            first_day_for(editor.draft, table, columns["time"], reading),
            EARLIEST,
            LATEST,
            key=f"{waiting.key}:day",
            help="The scenario is moved to begin on it; blank: it stays where it is.",
        )
    with days:
        count = ask_number(
            "Days",
            None,
            f"{waiting.key}:count",
            (Ge(1), Le(MOST_PROFILE_DAYS)),
            "Blank: as now.",
            whole=True,
            blank=True,
        )
    with hold:
        minutes = ask_number(
            "A value holds for, min",
            None,
            f"{waiting.key}:hold",
            (Ge(0.001),),
            "At most so long; then comes a gap, which is a fault. Blank: the table's usual step.",
            blank=True,
            placeholder="usual step",
        )
    with end:
        at_end = st.checkbox(
            "Times are ends",
            key=f"{waiting.key}:end",
            help="As in hour ending: a value holds until its time.",
        )
    asked = (count, minutes, *peaks.values())
    if wrong := tuple(number for number in asked if isinstance(number, Fault)):
        return wrong
    return ProfileRules(columns, units, reading, peaks, day, count, minutes, at_end)


def _units(
    waiting: WaitingTable, columns: Mapping[str, str]
) -> tuple[dict[str, str], dict[str, Any]]:
    """The unit of each column of values, and the peak of those in kW or MW where one is stated."""
    units: dict[str, str] = {}
    peaks: dict[str, Any] = {}
    row = st.columns(5)
    for place, field in enumerate(profile_columns.UNITS, 1):
        if not columns[field]:
            continue
        choices = list(profile_columns.UNITS[field])
        known = profile_columns.proposed_unit(field, columns[field])
        with row[place]:
            unit = st.selectbox(
                f"Unit of {field}",
                choices,
                index=choices.index(known) if known else None,
                placeholder="Choose",
                key=f"{waiting.key}:{field}:unit:{columns[field]}",
                help="Money of any currency counts as $." if field == "price" else POWER_HELP,
            )
            if unit in ("kW", "MW"):
                peak = ask_number(
                    f"Peak of {field}, kW",
                    None,
                    f"{waiting.key}:{field}:peak",
                    (Ge(0.001),),
                    "What the values are divided by; blank: the table's largest.",
                    blank=True,
                    placeholder="the table's own",
                )
                peaks |= {} if peak is None else {field: peak}
        units |= {} if unit is None else {field: unit}
    return units, peaks


def _confirm_sessions(editor: Editor, rules: SessionRules) -> None:
    _take_in(editor, "sessions", "the vehicles", partial(with_sessions, rules=rules))


def _confirm_profile(editor: Editor, rules: ProfileRules) -> None:
    used = ", ".join(profile_columns.TARGETS[field] for field in rules.units)
    _take_in(editor, "values", used, partial(with_profile, rules=rules))


def _take_in(editor: Editor, what: str, replaced: str, change: Change) -> None:
    waiting = editor.waiting
    if waiting is None:
        return
    try:
        changed, told = change(editor.draft, waiting.table)
    except InputError as error:
        title = f"The {what} were not taken in; your work is as it was."
        editor.said = Said(title, error.faults)
        return
    waiting.taken = True
    said = f"{plain(waiting.table.name)} replaced {plain(replaced)}."
    editor.take(changed, Said(said, notes=told))


def _leave(editor: Editor) -> None:
    editor.waiting = None
    editor.said = None
