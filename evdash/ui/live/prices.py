"""Energy prices by the hour: a table to be edited, whose edits count at once."""

import streamlit as st

from evdash.domain.outlook import Outlook
from evdash.errors import Fault
from evdash.files.numbers import number_text
from evdash.ui.session import Session
from evdash.ui.settings import help_text, price_field
from evdash.ui.typed import number_column, read_within, refuse, rows_as_typed
from evdash.ui.words import clock

COLUMN = "Price, $/kWh"
MOST_TOLD = 3


def take_prices(session: Session) -> bool:
    """Put prices typed since the table was last shown in force; whether all could be read.

    What cannot be read stays in its cell, and the price in force stays so.
    """
    state = st.session_state.get(_key(session))
    if state is None:
        return True
    typed = rows_as_typed([{COLUMN: text} for text in session.price_base], state, [COLUMN])
    read = [_read(row[COLUMN]) for row in typed]
    refused = {
        session.price_first + place: typed[place][COLUMN]
        for place, price in enumerate(read)
        if isinstance(price, Fault)
    }
    all_read = set(refused.items()) <= set(session.price_refused.items())
    session.price_refused = refused
    edited = tuple(
        held if isinstance(price, Fault) else float(price)
        for price, held in zip(read, session.price_latest, strict=True)
    )
    if edited != session.price_latest:
        session.price_latest = edited
        past = tuple(session.run.trace.scenario.price_per_kwh[: session.price_first].tolist())
        session.edit("the edited energy prices", {}, (*past, *edited))
    return all_read


def _key(session: Session) -> str:
    return f"prices:{session.price_revision}"


def _read(text: str) -> float | Fault:
    return read_within(COLUMN, text, price_field().metadata)


def price_editor(session: Session, outlook: Outlook) -> None:
    """Energy prices still to come as a table of text.

    The editor keeps only differences to the table it was given, so that stays the same until
    prices change elsewhere, an edit is refused, or it was closed; then it begins anew.
    """
    # half a second that the first page is not to wait for
    import pandas as pd  # noqa: PLC0415

    trace = session.run.trace
    first = 0 if trace.is_over else trace.now
    prices = tuple(trace.scenario.price_per_kwh[first:].tolist())
    shown = session.price_first, session.price_latest
    if shown != (first, prices) or _key(session) not in st.session_state:
        session.price_first, session.price_latest = first, prices
        session.price_base = tuple(
            session.price_refused.get(t, number_text(price))
            for t, price in enumerate(prices, first)
        )
        session.price_revision += 1
    times = [clock(moment, outlook) for moment in outlook.times[first:-1]]
    st.caption("Applies to the next run." if trace.is_over else "Hours already decided are fixed.")
    st.data_editor(
        pd.DataFrame({"From": times, COLUMN: session.price_base}),
        key=_key(session),
        hide_index=True,
        disabled=["From"],
        height=420,
        column_config={COLUMN: number_column(COLUMN, help_text(price_field()))},
        alt="Energy price of every interval still to come, editable",
    )


def refused_prices(session: Session, outlook: Outlook) -> None:
    """What stands in the table of prices and is none; also while the table is closed."""
    trace = session.run.trace
    first = 0 if trace.is_over else trace.now
    left = {t: text for t, text in session.price_refused.items() if t >= first}
    for t, text in list(left.items())[:MOST_TOLD]:
        held = number_text(float(trace.scenario.price_per_kwh[t]))
        wrong = _read(text)
        if isinstance(wrong, Fault):
            refuse(wrong, f"The price from {clock(outlook.times[t], outlook)} stays {held} $/kWh.")
    if len(left) > MOST_TOLD:
        st.caption(f":red[And {len(left) - MOST_TOLD} more in the table.]")
