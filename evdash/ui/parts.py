"""What panels are put together from: the horizon as shown, charts, tables."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import streamlit as st

from evdash.charts.drawn import Drawn
from evdash.charts.style import CONFIG, Figure
from evdash.domain.outlook import Outlook
from evdash.metrics.outlook import outlook
from evdash.ui.session import Session
from evdash.ui.words import (
    markdown_table,
)

ROW_PX = 29


def view(session: Session) -> Outlook:
    """The horizon as it stands."""
    return session.once("outlook", lambda: outlook(session.run.trace))


def chart(
    session: Session,
    name: str,
    draw: Callable[[], Figure],
    alt: str,
    detail: object = None,
) -> None:
    """A chart, drawn anew only for another trace or detail."""
    key = f"chart_{name}"
    figure = session.once(key, lambda: Drawn(draw(), session.width_px.get(key)), detail=detail)
    show(figure, key, alt)


def show(figure: Drawn, key: str, alt: str, **selection: Any) -> None:
    """A figure in the page, in its own look: Streamlit's theme would have it drawn twice."""
    st.plotly_chart(figure, key=key, config=CONFIG, alt=alt, theme=None, **selection)


def table_below(
    name: str, rows: Callable[[], list[dict[str, object]]], label: str = "As a table"
) -> None:
    """Numbers as a table, made only when opened."""
    box = st.expander(label, key=f"table_{name}", type="compact", on_change="rerun")
    if box.open:
        with box:
            table(rows(), f"The numbers of the {name} chart")


def table(rows: list[dict[str, object]], alt: str) -> None:
    """Rows as a data grid."""
    st.dataframe(rows, hide_index=True, alt=alt)


def small_table(rows: Sequence[Mapping[str, object]], height: int) -> None:
    """A table that changes with every step: text costs a browser a tenth of a data grid."""
    fits = ROW_PX * (len(rows) + 1) <= height
    with st.container(height="content" if fits else height, border=False):
        st.markdown(markdown_table(rows))
