"""What a study found, as the picture that fits what it varies."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from evdash.charts.study_bands import Bands, bands_alt, bands_figure, days_alt, days_figure
from evdash.charts.study_heat import heat_alt, heat_figure
from evdash.charts.style import Figure
from evdash.domain.study import Band
from evdash.studies.measures import MEASURES
from evdash.studies.tables import QUANTILES, Found

MOST_SERIES = 6


@dataclass(frozen=True, slots=True)
class Dimension:
    """Something that varies: its place in a band's group, its title, its labels in order."""

    place: int
    title: str
    labels: tuple[object, ...]


@dataclass(frozen=True, slots=True)
class Picture:
    """A figure, what kind it is, and what it shows in a sentence."""

    kind: str
    figure: Figure
    alt: str


def dimensions(found: Found) -> list[Dimension]:
    """What varies in a study: axes, policies and network models with more than one value."""
    groups = [group.cells for group in found.groups()]
    titles = (*found.runs.axes, "policy", "network model")
    every = (
        Dimension(place, title, tuple(dict.fromkeys(group[place] for group in groups)))
        for place, title in enumerate(titles)
    )
    return [one for one in every if len(one.labels) > 1]


def at_first(rows: Sequence[Band], dimension: Dimension) -> list[Band]:
    """The bands at the first value of a dimension."""
    return [band for band in rows if band.group[dimension.place] == dimension.labels[0]]


def picture(
    found: Found,
    metric: str,
    rows: Sequence[Band],
    varied: Sequence[Dimension],
    paired: bool = False,
) -> Picture:
    """Bands along one axis, in series or as a heat map along two, all days where nothing varies.

    `rows` are the metric's bands at one value of every dimension beyond the second; `paired` where
    they are of differences.
    """
    value = MEASURES[metric].head + (", difference" if paired else "")
    if not varied:
        return _days(found, metric, value)
    by = varied[1] if len(varied) > 1 else None
    if by is None or by.place >= len(found.runs.axes):
        series, title = _series(rows, varied[0], by), varied[0].title
        drawn = bands_figure(series, title, value, zero=paired)
        return Picture("bands", drawn, bands_alt(series, title, value))
    return _heat(rows, varied[0], by, metric, value)


def _days(found: Found, metric: str, value: str) -> Picture:
    known = [found.value(run, metric) for run in found.runs.runs]
    values = [one for one in known if one is not None]
    quantiles = [float(q) for q in np.quantile(values, QUANTILES)] if values else []
    drawn = days_figure(values, quantiles, value)
    return Picture("days", drawn, days_alt(values, quantiles, value))


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


def _heat(
    rows: Sequence[Band], across: Dimension, down: Dimension, metric: str, value: str
) -> Picture:
    cells = {(band.group[down.place], band.group[across.place]): band.p50 for band in rows}
    values = [[cells.get((row, column)) for column in across.labels] for row in down.labels]
    tell = MEASURES[metric].told
    told = [[tell(cell) for cell in row] for row in values]
    drawn = heat_figure(across.labels, down.labels, values, (across.title, down.title, value), told)
    alt = heat_alt(across.labels, down.labels, values, (across.title, down.title, value))
    return Picture("heat", drawn, alt)
