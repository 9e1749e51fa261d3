"""A study of many days, as tables and pictures."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import pandas as pd
from filelock import Timeout

from evdash.charts.standalone import PlotlyFigure, as_plotly
from evdash.domain.study import StudyRuns
from evdash.errors import Fault, InputError
from evdash.files.bundled import located_study
from evdash.files.frames import table_frame
from evdash.studies.crew import Crew
from evdash.studies.drawing import at_first, dimensions, picture
from evdash.studies.engine import Progress, run_study
from evdash.studies.folder import Busy, StudyFolder
from evdash.studies.reading import read_study
from evdash.studies.tables import Found, bands, bands_table, reference_bands, runs_table


def study(file: str | Path, folder: str | Path | None = None, *, workers: int = 0) -> "Study":
    """Run a study file.

    Parameters
    ----------
    file : str or Path
        A study file (docs/studies.md), or the name of a bundled one, such as
        ``how-many-chargers``.
    folder : str or Path, optional
        Where results land one by one; the same call resumes a study that was stopped.
    workers : int, default 0
        Processes; 0: one for every core.

    Returns
    -------
    Study

    Raises
    ------
    InputError
        With every fault in the file, or for a folder that cannot be used.
    """
    return run_here(read_study(located_study(file)), folder, workers)


def run_here(runs: StudyRuns, folder: str | Path | None, workers: int) -> "Study":
    """Run a study in a folder, or in one that goes when it is done."""
    if folder is not None:
        return Study(in_folder(runs, StudyFolder(Path(folder)), Crew(workers)))
    with TemporaryDirectory(prefix="evdash-study-") as own:
        return Study(in_folder(runs, StudyFolder(Path(own)), Crew(workers)))


def in_folder(
    runs: StudyRuns,
    folder: StudyFolder,
    crew: Crew,
    told: Callable[[Progress], None] = lambda _: None,
) -> Found:
    """Run what of a study its folder does not hold yet, and write its tables there."""
    folder.make()
    try:
        with folder.lock():
            folder.begin(runs)
            run_study(runs, folder.results, crew, told)
            found = folder.found(runs)
            folder.write_tables(found)
    except Timeout as error:
        raise Busy(f"{folder.path}: another process is running this study") from error
    return found


@dataclass(frozen=True, slots=True, repr=False)
class Study:
    """Many days and what they show, made by `Scenario.study` or `study`.

    Attributes
    ----------
    data : evdash.studies.tables.Found
        The runs and their results.
    """

    data: Found

    def __repr__(self) -> str:
        runs = self.data.runs
        return f"<Study {runs.study.name!r}: {len(runs.points)} points, {len(runs.runs)} days>"

    @property
    def runs(self) -> pd.DataFrame:
        """A row for each day: where it stands on the axes, seed, status, metrics; `runs.csv`."""
        return table_frame(*runs_table(self.data))

    @property
    def summary(self) -> pd.DataFrame:
        """Every metric over the days of every point: mean, 5, 50, 95 % of days; `summary.csv`."""
        return table_frame(*bands_table(self.data, bands(self.data)))

    @property
    def differences(self) -> pd.DataFrame:
        """As `summary`, of each day less the same day at the first point; `differences.csv`."""
        return table_frame(*bands_table(self.data, reference_bands(self.data)))

    def plot(self, metric: str | None = None, *, paired: bool = False) -> PlotlyFigure:
        """Draw a metric along what varies: bands of days, a heat map, or all days as they are.

        Parameters
        ----------
        metric : str, optional
            One of the study's metrics; by default the first.
        paired : bool, default False
            Draw the difference to the first point, day by day.

        Returns
        -------
        plotly.graph_objects.Figure
            Of dimensions beyond the second, the first value is shown.

        Raises
        ------
        InputError
            For a metric the study has not.

        Examples
        --------
        >>> import evdash
        >>> scenario = evdash.load("summer-weekday", {"arrivals.vehicles_per_day": 10})
        >>> study = scenario.study({"station.chargers": [1, 2]}, days=2, workers=1)
        >>> study
        <Study 'Summer weekday': 2 points, 4 days>
        >>> study.plot("admitted").layout.yaxis.title.text
        'Admitted, vehicles'
        """
        found, names = self.data, self.data.metrics
        metric = metric or names[0]
        if metric not in names:
            raise InputError([Fault("metric", repr(metric), f"should be of {', '.join(names)}")])
        varied = dimensions(found)
        told = reference_bands(found) if paired else bands(found)
        rows = [band for band in told if band.metric == metric]
        for dimension in varied[2:]:
            rows = at_first(rows, dimension)
        return as_plotly(picture(found, metric, rows, varied, paired).figure)
