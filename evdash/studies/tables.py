"""What a study found, as tidy tables: every run, bands over the seeds, differences in pairs."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from evdash.domain.study import Band, Result, Run, StudyRuns
from evdash.files.tables import write_table
from evdash.studies.measures import MEASURES, TEXTS

QUANTILES = (0.05, 0.5, 0.95)
BAND_COLUMNS = ("metric", "unit", "days", "mean", "standard_error", "p05", "p50", "p95")
MISSING = "not run yet"


@dataclass(frozen=True, slots=True)
class Group:
    """Runs that differ in their seed only: the labels of the axes, policy, network model."""

    labels: tuple[object, ...]
    policy: str
    network: str

    @property
    def cells(self) -> tuple[object, ...]:
        return (*self.labels, self.policy, self.network)


@dataclass(frozen=True, slots=True)
class Found:
    """A study's runs with the results there are of them so far."""

    runs: StudyRuns
    results: Mapping[str, Result]

    def groups(self) -> dict[Group, list[Run]]:
        """The runs by group, in the order of the study."""
        grouped: dict[Group, list[Run]] = {}
        for run in self.runs.runs:
            labels = self.runs.points[run.point].labels
            grouped.setdefault(Group(labels, run.policy, run.network), []).append(run)
        return grouped

    def value(self, run: Run, metric: str) -> float | None:
        """A figure of a run; None where it failed, is still to come, or has none."""
        result = self.results.get(run.key)
        value = result.figures.get(metric) if result is not None else None
        return float(value) if isinstance(value, int | float) else None

    @property
    def metrics(self) -> tuple[str, ...]:
        """The study's measures that are numbers."""
        return tuple(name for name in self.runs.study.metrics if name not in TEXTS)


def bands(found: Found) -> list[Band]:
    """Every metric over the seeds of every group."""
    return [
        band
        for group, runs in found.groups().items()
        for metric in found.metrics
        for band in _band(group.cells, metric, [found.value(run, metric) for run in runs])
    ]


def reference_bands(found: Found) -> list[Band]:
    """How every group differs from the first of its policy and network model, in pairs of the
    same seed: the first value of every axis is what the others are held against.

    Where policies or networks are all that varies, the first of them is held against instead.
    """
    groups = found.groups()
    told: list[Band] = []
    for group, runs in groups.items():
        first = _reference(group, groups)
        if first is None:
            continue
        base = {run.seed: run for run in groups[first]}
        for metric in found.metrics:
            pairs = [
                (found.value(run, metric), found.value(base[run.seed], metric)) for run in runs
            ]
            differences = [None if a is None or b is None else a - b for a, b in pairs]
            told += _band(group.cells, metric, differences)
    return told


def _reference(group: Group, groups: Mapping[Group, list[Run]]) -> Group | None:
    """What a group is held against; None for what others are held against."""
    first = next(iter(groups))
    rest = {known.labels for known in groups}
    same = first if len(rest) == 1 else Group(first.labels, group.policy, group.network)
    return same if same != group else None


def _band(group: tuple[object, ...], metric: str, values: Sequence[float | None]) -> Iterator[Band]:
    known = np.array([value for value in values if value is not None and np.isfinite(value)])
    if known.size == 0:
        return
    low, middle, high = (float(q) for q in np.quantile(known, QUANTILES))
    error = float(known.std(ddof=1) / np.sqrt(known.size)) if known.size > 1 else None
    yield Band(group, metric, known.size, float(known.mean()), error, low, middle, high)


Table = tuple[list[str], Iterator[list[object]]]
"""The head and the rows of a table."""


def csv_text(table: Table) -> str:
    """A table as CSV, its text such that no spreadsheet takes it for a formula."""
    head, rows = table
    return write_table(head, ([_harmless(cell) for cell in row] for row in rows))


def runs_table(found: Found) -> Table:
    """Every run: where it stands on the axes, what became of it, its figures."""
    study = found.runs.study
    head = [*found.runs.axes, "policy", "network", "seed", "status", "reason"]
    return [*head, *study.metrics, "key"], _run_rows(found)


def _run_rows(found: Found) -> Iterator[list[object]]:
    metrics = found.runs.study.metrics
    for run in found.runs.runs:
        result = found.results.get(run.key)
        status, reason = (result.status, result.reason) if result else (MISSING, "")
        figures = [result.figures.get(name) if result else None for name in metrics]
        labels = found.runs.points[run.point].labels
        told = (*labels, run.policy, run.network, run.seed, status, " ".join(reason.split()))
        yield [*told, *figures, run.key]


def _harmless(cell: object) -> object:
    """Text that no spreadsheet takes for a formula."""
    return f"'{cell}" if isinstance(cell, str) and cell[:1] in tuple("=+-@\t\r") else cell


def bands_table(found: Found, rows: Sequence[Band]) -> Table:
    """Bands, a row each."""
    return [*found.runs.axes, "policy", "network", *BAND_COLUMNS], _band_rows(rows)


def _band_rows(rows: Sequence[Band]) -> Iterator[list[object]]:
    for band in rows:
        count = (band.metric, MEASURES[band.metric].unit, band.days)
        quantiles = (band.mean, band.error, band.p05, band.p50, band.p95)
        yield [*band.group, *count, *quantiles]
