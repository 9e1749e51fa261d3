"""What a study found, in pictures that fit what it varies, each with its table."""

from collections.abc import Sequence

import streamlit as st

from evdash.charts.drawn import Drawn
from evdash.charts.study_bands import Bands, bands_alt, bars_figure
from evdash.charts.study_map import site_alt, site_map
from evdash.charts.style import Figure
from evdash.domain.study import Band, Study
from evdash.studies.drawing import Dimension, dimensions, picture
from evdash.studies.measures import MEASURES
from evdash.studies.tables import Found, bands, reference_bands
from evdash.ui.parts import show, table_below
from evdash.ui.studies.words import answer, everywhere, is_less_better
from evdash.ui.words import plain

SITE = "station.node"
DIFFERENCE_HELP = (
    "Each day against the same day at the first value of every axis (or under the first policy "
    "where nothing else varies): what differs is then not the luck of who came."
)


def pictures(found: Found, number: str) -> None:
    """The answer in a sentence, the picture of one metric, its table; of the study so numbered."""
    metrics = found.metrics
    if not metrics:
        st.info("This study tells words only; its tables hold them.")
        return
    with st.container(horizontal=True, vertical_alignment="bottom", key="study_head"):
        metric = st.selectbox(
            "What to show",
            metrics,
            format_func=lambda name: MEASURES[name].head,
            key=f"study_metric_{number}",
            persist_state="session",
            width=320,
            help="What is drawn of every point; the table below has all of them.",
        )
        varied = dimensions(found)
        paired = bool(varied) and st.toggle(
            "Difference from the first, day by day",
            key=f"study_paired_{number}",
            help=DIFFERENCE_HELP,
        )
    metric = metric if metric in metrics else metrics[0]
    st.caption(MEASURES[metric].meaning)
    rows = reference_bands(found) if paired else bands(found)
    if said := ("" if paired else answer(found, rows, metric)) or everywhere(found):
        st.markdown(said)
    mine = _chosen([band for band in rows if band.metric == metric], varied)
    _draw(found, metric, mine, varied, paired)
    table_below("study", lambda: _table(found, rows), "All metrics as a table")


def _chosen(rows: list[Band], varied: list[Dimension]) -> list[Band]:
    """Bands at one value of every dimension beyond the second."""
    for one in varied[2:]:
        label = st.selectbox(
            plain(one.title),
            one.labels,
            format_func=lambda value: f"{value}",
            key=f"study_at_{one.place}",
            help="A picture has two dimensions: of this one, this value is shown.",
        )
        rows = [band for band in rows if band.group[one.place] == label]
    return rows


def _draw(
    found: Found, metric: str, rows: list[Band], varied: list[Dimension], paired: bool
) -> None:
    sites = next((one for one in varied if one.title == _site_title(found)), None)
    if sites is not None and not paired:
        _sites(found, metric, rows, sites)
        if len(varied) == 1:
            return
    drawn = picture(found, metric, rows, varied, paired)
    _chart(f"study_{drawn.kind}", drawn.figure, drawn.alt)


def _chart(name: str, drawn: Figure, alt: str) -> None:
    show(Drawn(drawn), f"chart_{name}", alt)


def _site_title(found: Found) -> str:
    return next((axis.title for axis in found.runs.study.axis if axis.key == SITE), "")


def _sites(found: Found, metric: str, rows: list[Band], sites: Dimension) -> None:
    """Bars by node and the feeder as a map, of the first policy and network model."""
    value = MEASURES[metric].head
    first: dict[str, Band] = {}
    for band in rows:
        first.setdefault(f"{band.group[sites.place]}", band)
    tell = MEASURES[metric].told
    bars = Bands(
        "", list(first), *([getattr(b, q) for b in first.values()] for q in ("p05", "p50", "p95"))
    )
    middles = {node: band.p50 for node, band in first.items()}
    told = {node: tell(middle) for node, middle in middles.items()}
    least = is_less_better(metric)
    _chart(
        "study_map",
        site_map(found.runs.base, middles, told, value, least_is_best=least),
        site_alt(middles, value),
    )
    _chart(
        "study_bars",
        bars_figure(bars, "Node of the station", value),
        bands_alt([bars], "node", value),
    )


def _table(found: Found, rows: Sequence[Band]) -> list[dict[str, object]]:
    varied = dimensions(found)
    return [
        {one.title: band.group[one.place] for one in varied}
        | {
            "metric": MEASURES[band.metric].head,
            "days": band.days,
            "5 %": band.p05,
            "median": band.p50,
            "95 %": band.p95,
            "mean": band.mean,
            "standard error": band.error,
        }
        for band in rows
    ]


def heading(study: Study) -> None:
    """What the study is about."""
    st.markdown(f"#### {plain(study.question or study.name)}")
