"""What a study found, in pictures that fit what it varies, each with its table."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import streamlit as st

from evdash.charts.drawn import Drawn
from evdash.charts.study_bands import (
    Bands,
    bands_alt,
    bands_figure,
    bars_figure,
    days_alt,
    days_figure,
)
from evdash.charts.study_heat import heat_alt, heat_figure
from evdash.charts.study_map import site_alt, site_map
from evdash.charts.style import Figure
from evdash.domain.study import Band, Study
from evdash.studies.measures import MEASURES
from evdash.studies.tables import QUANTILES, Found, bands, reference_bands
from evdash.ui.parts import show, table_below
from evdash.ui.studies.words import answer, everywhere, is_less_better
from evdash.ui.words import plain

SITE = "station.node"
MOST_SERIES = 6
DIFFERENCE_HELP = (
    "Each day against the same day at the first value of every axis (or under the first policy "
    "where nothing else varies): what differs is then not the luck of who came."
)


@dataclass(frozen=True, slots=True)
class Dimension:
    """Something that varies: its place in a band's group, its title, its labels in order."""

    place: int
    title: str
    labels: tuple[object, ...]


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


def dimensions(found: Found) -> list[Dimension]:
    """What varies in a study: axes, policies and network models with more than one value."""
    groups = [group.cells for group in found.groups()]
    titles = (*found.runs.axes, "policy", "network model")
    every = (
        Dimension(place, title, tuple(dict.fromkeys(group[place] for group in groups)))
        for place, title in enumerate(titles)
    )
    return [one for one in every if len(one.labels) > 1]


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
    value = MEASURES[metric].head + (", difference" if paired else "")
    if not varied:
        _days(found, metric, value)
        return
    sites = next((one for one in varied if one.title == _site_title(found)), None)
    if sites is not None and not paired:
        _sites(found, metric, rows, sites, value)
        if len(varied) == 1:
            return
    policy = varied[1] if len(varied) > 1 else None
    if policy is None or policy.place >= len(found.runs.axes):
        series = _series(rows, varied[0], policy)
        drawn = bands_figure(series, varied[0].title, value, zero=paired)
        _chart("study_bands", drawn, bands_alt(series, varied[0].title, value))
    else:
        _heat(rows, varied[0], policy, metric, value)


def _chart(name: str, drawn: Figure, alt: str) -> None:
    show(Drawn(drawn), f"chart_{name}", alt)


def _site_title(found: Found) -> str:
    return next((axis.title for axis in found.runs.study.axis if axis.key == SITE), "")


def _days(found: Found, metric: str, value: str) -> None:
    known = [found.value(run, metric) for run in found.runs.runs]
    values = [one for one in known if one is not None]
    quantiles = [float(q) for q in np.quantile(values, QUANTILES)] if values else []
    _chart(
        "study_days",
        days_figure(values, quantiles, value),
        days_alt(values, quantiles, value),
    )


def _series(rows: Sequence[Band], axis: Dimension, by: Dimension | None) -> list[Bands]:
    series = []
    for label in by.labels[:MOST_SERIES] if by else ("",):
        mine = [band for band in rows if by is None or band.group[by.place] == label]
        series.append(
            Bands(
                name=f"{label}",
                at=[band.group[axis.place] for band in mine],
                p05=[band.p05 for band in mine],
                p50=[band.p50 for band in mine],
                p95=[band.p95 for band in mine],
            )
        )
    return series


def _sites(found: Found, metric: str, rows: list[Band], sites: Dimension, value: str) -> None:
    """Bars by node and the feeder as a map, of the first policy and network model."""
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


def _heat(
    rows: Sequence[Band], across: Dimension, down: Dimension, metric: str, value: str
) -> None:
    cells = {(band.group[down.place], band.group[across.place]): band.p50 for band in rows}
    values = [[cells.get((row, column)) for column in across.labels] for row in down.labels]
    tell = MEASURES[metric].told
    told = [[tell(cell) for cell in row] for row in values]
    titles = (across.title, down.title, value)
    _chart(
        "study_heat",
        heat_figure(across.labels, down.labels, values, titles, told),
        heat_alt(across.labels, down.labels, values, titles),
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
