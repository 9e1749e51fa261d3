"""A finished day: its tables, figures, explanations and pictures."""

import json
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import pandas as pd

from evdash.charts.standalone import PlotlyFigure, as_plotly
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.errors import Fault, InputError
from evdash.explain.binding import binding_elements
from evdash.explain.refusals import Explanation, explain_vehicle, explanations
from evdash.explain.revisions import explain_revision
from evdash.explain.worth import day_worths
from evdash.files.exchange import output_folder, put_files
from evdash.files.explanation_rows import BindingRow, ExplanationRow, RevisionRow, WorthRow
from evdash.files.explanation_table import binding_rows, refusal_row, revision_row, worth_row
from evdash.files.frames import frame
from evdash.files.run_export import RunLabel, Verdict, voltage_rows
from evdash.files.run_folder import SUMMARY, is_run, write_run
from evdash.files.run_tables import (
    IntervalRow,
    LedgerRow,
    PowerRow,
    VehicleRow,
    VoltageRow,
    interval_rows,
    ledger_rows,
    power_rows,
    vehicle_rows,
)
from evdash.metrics.ac_day import AcDay
from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service, service
from evdash.reports import charts
from evdash.reports.account import Account, account, verdict_on
from evdash.reports.html import report_html
from evdash.reports.words import kept_plans, limit_lines, promises_line
from evdash.reports.workbook import workbook_bytes

CHARTS: Mapping[str, Callable[[Account], charts.Chart | None]] = {
    "schedule": charts.schedule_chart,
    "admissions": charts.admissions_chart,
    "load": charts.load_chart,
    "headroom": charts.headroom_chart,
    "voltages": charts.voltages_chart,
    "gap": charts.gap_chart,
    "feeder": charts.feeder_chart,
    "hot_spot": charts.hot_spot_chart,
}


@dataclass(frozen=True, repr=False)
class Day:
    """A day that was run, made by `Scenario.run`.

    Its tables are those of the files a run writes (docs/scenario.md), column for column and to the
    last digit; ``table.attrs["units"]`` has their units. What takes longer, such as AC power flow
    and explanations, is worked out when first asked for.

    Attributes
    ----------
    trace : evdash.domain.trace.Trace
        Every step: what was known, the plan, the state after it.
    label : evdash.files.run_export.RunLabel
        What it was made with: `policy`, `network`, `seed`, and `wall_seconds`.

    Examples
    --------
    >>> import evdash
    >>> day = evdash.load("summer-weekday").run()
    >>> print(day)
    Summer weekday, p1: 51 of 99 vehicles admitted; every promise kept: in full and on time.
    >>> day.vehicles.status.value_counts().to_dict()
    {'charged': 51, 'refused': 48}
    >>> day.power.attrs["units"]
    {'power_kw': 'kW'}
    """

    trace: Trace
    label: RunLabel

    def __repr__(self) -> str:
        return f"<Day {self.trace.scenario.name!r}, {self.label.policy}, {self.label.network}>"

    def __str__(self) -> str:
        told = "\n".join([promises_line(self.account)[1], *kept_plans(self.trace)])
        return f"{self.trace.scenario.name}, {self.label.policy}: {told}"

    @cached_property
    def intervals(self) -> pd.DataFrame:
        """What was decided in each interval: prices, vehicles, power, headroom; `intervals.csv`."""
        return frame(IntervalRow, interval_rows(self.trace))

    @cached_property
    def vehicles(self) -> pd.DataFrame:
        """Everyone who asked, what for, and what became of it; `vehicles.csv`."""
        return frame(VehicleRow, vehicle_rows(self.trace))

    @cached_property
    def ledger(self) -> pd.DataFrame:
        """Every promise and whether it was kept; `ledger.csv`."""
        return frame(LedgerRow, ledger_rows(self.trace))

    @cached_property
    def power(self) -> pd.DataFrame:
        """Power executed by interval and vehicle, where there is any; `power.csv`."""
        return frame(PowerRow, power_rows(self.trace))

    @cached_property
    def voltages(self) -> pd.DataFrame:
        """Every node's voltage by interval, linearised and by AC power flow; `voltages.csv`."""
        return frame(VoltageRow, voltage_rows(self.verdict))

    @cached_property
    def figures(self) -> pd.DataFrame:
        """The day in figures: a row each by name, with label, unit, value and meaning.

        Examples
        --------
        >>> import evdash
        >>> figures = evdash.load("summer-weekday").run().figures
        >>> f"{figures.value['profit']:.2f} {figures.unit['profit']}"
        '255.77 $'
        """
        of_day = service(self.trace, AcDay(self.verdict.flow, self.verdict.ac))
        rows = {
            one.name: (one.label, one.unit, getattr(of_day, one.name), one.meaning)
            for one in figures_of(Service)
        }
        columns = ["label", "unit", "value", "meaning"]
        return pd.DataFrame.from_dict(rows, orient="index", columns=columns)

    @cached_property
    def summary(self) -> dict[str, Any]:
        """Totals, verdicts, and what the run was made with; `summary.json`."""
        told: dict[str, Any] = json.loads(self.account.files[SUMMARY])
        return told

    @cached_property
    def verdict(self) -> Verdict:
        """The day held against its limits in the linearised model and in AC power flow."""
        return verdict_on(self.trace)

    @cached_property
    def account(self) -> Account:
        """Everything the report tells."""
        return account(self.trace, self.verdict, self.label)

    @cached_property
    def outlook(self) -> Outlook:
        """Load, headroom and voltages of the day as the charts show them."""
        return self.account.outlook

    @property
    def is_sound(self) -> bool:
        """Whether every promise and every limit of the network model was kept."""
        beyond = self.verdict.broken_by_station(self.label.network)
        return not self.account.totals.broken and not beyond

    @property
    def sentences(self) -> tuple[str, ...]:
        """What became of promises and limits, and when and why the last plan was kept."""
        limits = (told for _, told in limit_lines(self.account))
        return (promises_line(self.account)[1], *limits, *kept_plans(self.trace))

    def explain(self, vehicle: str) -> Explanation:
        """Explain a refusal: why, and the least change that would have admitted the vehicle.

        Parameters
        ----------
        vehicle : str
            Name of a vehicle that was refused.

        Returns
        -------
        evdash.explain.refusals.Explanation
            With `detail`, `remedy` and, of both, `text`.

        Raises
        ------
        InputError
            For a vehicle that was not refused.

        Examples
        --------
        >>> import evdash
        >>> day = evdash.load("summer-weekday").run()
        >>> refused = day.vehicles.query("status == 'refused'").vehicle
        >>> print(day.explain(refused.iloc[0]).text)
        Refused because newcomers who earn more took its place: ...
        """
        try:
            return explain_vehicle(self.trace, vehicle)
        except ValueError:
            fault = Fault("vehicle", repr(vehicle), "should be one that was refused")
            raise InputError([fault]) from None

    @cached_property
    def explanations(self) -> pd.DataFrame:
        """Every refusal explained, which takes seconds; `explanations.csv`."""
        return frame(ExplanationRow, map(refusal_row, explanations(self.trace)))

    @cached_property
    def worths(self) -> pd.DataFrame:
        """What one more charger, a higher rating, a wider voltage band are worth; `worths.csv`.

        Of days that `p1` decided; the day is run again for each.
        """
        if self.label.policy != "p1":
            fault = Fault("worths", f"a day of {self.label.policy}", "are told of p1 alone")
            raise InputError([fault])
        return frame(WorthRow, map(worth_row, day_worths(self.trace)))

    @cached_property
    def binding(self) -> pd.DataFrame:
        """Which limit is tightest, and which is reached, in which interval; `binding.csv`."""
        return frame(BindingRow, binding_rows(self.trace.scenario, binding_elements(self.trace)))

    @cached_property
    def revisions(self) -> pd.DataFrame:
        """What each interval's decision changed in the plan before it, and why; `revisions.csv`."""
        told = (explain_revision(self.trace, step.interval) for step in self.trace.steps[1:])
        return frame(RevisionRow, map(revision_row, told))

    def plot(self, kind: str = "schedule") -> PlotlyFigure:
        """Draw the day.

        Parameters
        ----------
        kind : str, default "schedule"
            One of "schedule", "admissions", "load", "headroom", "voltages", "gap" (linearised
            against AC), "feeder" (when the station draws most), "hot_spot" (of the transformer).

        Returns
        -------
        plotly.graph_objects.Figure

        Raises
        ------
        InputError
            For a picture there is none of.

        Examples
        --------
        >>> import evdash
        >>> evdash.load().run().plot("load").layout.yaxis.title.text
        'Station, kW'
        """
        chart = CHARTS[kind](self.account) if kind in CHARTS else None
        if chart is None:
            found = "no transformer that is known" if kind in CHARTS else repr(kind)
            raise InputError([Fault("kind", found, f"should be one of {', '.join(CHARTS)}")])
        return as_plotly(chart.figure)

    def save(self, folder: str | Path, *, force: bool = False) -> None:
        """Write the run's folder, as `evdash run --out` does.

        Parameters
        ----------
        folder : str or Path
            New, empty, or an earlier run's.
        force : bool, default False
            Replace an earlier run.

        Raises
        ------
        InputError
            For a folder that must not or cannot be written to.
        """
        with output_folder(Path(folder), "run", is_run, force) as claim:
            write_run(claim, self.account.files)

    def report(self, file: str | Path) -> None:
        """Write the report, one HTML file that needs nothing else, or an Excel workbook.

        Parameters
        ----------
        file : str or Path
            Ends in ``.html`` or ``.xlsx``.

        Raises
        ------
        InputError
            For another ending, or a place that cannot be written.
        """
        path, told = Path(file), self.account
        if path.suffix not in (".html", ".xlsx"):
            raise InputError([Fault("file", repr(path.name), "should end in .html or .xlsx")])
        made = report_html(told).encode() if path.suffix == ".html" else workbook_bytes(told)
        put_files({path: made})
