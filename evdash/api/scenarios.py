"""A scenario on its way into a day, a race or a study."""

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from evdash.api.days import Day
from evdash.api.deciders import Own, check_network, check_some, rule_of, rules_of
from evdash.api.races import Race
from evdash.api.studies import Study, run_here
from evdash.domain import scenario as domain
from evdash.domain.arrivals import LOCAL_TIME_FORMAT, Arrival
from evdash.domain.events import Event
from evdash.domain.study import Study as StudyForm
from evdash.domain.trace import Network
from evdash.errors import Fault, InputError
from evdash.files.bundled import bundled_scenarios, is_there, located
from evdash.files.draft import zipped
from evdash.files.exchange import put_files
from evdash.files.frames import frame
from evdash.files.run_export import RunLabel
from evdash.files.scenario_folder import (
    FILE_NAMES,
    SETTINGS,
    parse_scenario,
    read_scenario,
    resolved,
    scenario_files,
)
from evdash.horizon.arrivals import arrivals_of
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.policies.race import CONTESTANTS, race
from evdash.policies.registry import all_given
from evdash.studies.keys import with_settings
from evdash.studies.reading import lay_out, study_of

METRICS = StudyForm.model_fields["metrics"].default


def load(
    source: str | Path = "summer-weekday", settings: Mapping[str, object] | None = None
) -> "Scenario":
    """Read a scenario.

    Parameters
    ----------
    source : str or Path, default "summer-weekday"
        A scenario folder, a ``.zip`` of one, or the name of a bundled one: ``summer-weekday``,
        ``winter-weekday``, ``price-spike``, ``negative-price``, ``past-midnight``,
        ``voltage-limited``.
    settings : mapping, optional
        Keys of ``scenario.toml`` and their values, as ``--set`` takes them.

    Returns
    -------
    Scenario

    Raises
    ------
    InputError
        With every fault there is, in ``faults``.

    Examples
    --------
    >>> import evdash
    >>> evdash.load("price-spike", {"station.chargers": 6})
    <Scenario 'Price spike': 13 nodes, 24 intervals of 60 min, 6 chargers>
    """
    place = located(source)
    if not is_there(place):
        names = ", ".join(folder.name for folder in bundled_scenarios())
        rule = f"should be a scenario folder, a .zip of one, or one of {names}"
        raise InputError([Fault(str(source), "nothing there", rule)])
    scenario = Scenario(read_scenario(place))
    return scenario.replace(settings) if settings else scenario


@dataclass(frozen=True, slots=True, repr=False)
class Scenario:
    """A scenario: everything that decides a day, but the policy.

    Made by `load`. It never changes; `replace` gives another one.

    Attributes
    ----------
    data : evdash.domain.scenario.Scenario
        The scenario's own records, of which docs/scenario.md tells every field.
    """

    data: domain.Scenario

    def __repr__(self) -> str:
        one = self.data
        return (
            f"<Scenario {one.name!r}: {len(one.nodes)} nodes, {one.intervals} intervals of "
            f"{one.interval_minutes} min, {one.station.chargers} chargers>"
        )

    @property
    def nodes(self) -> pd.DataFrame:
        """The feeder's nodes with their peak loads (kW, kvar) and ratings (kVA), `nodes.csv`."""
        return frame(domain.Node, self.data.nodes)

    @property
    def lines(self) -> pd.DataFrame:
        """Lines, switches and transformers (ohm, kVA), `lines.csv`."""
        return frame(domain.Line, self.data.lines)

    @property
    def profile(self) -> pd.DataFrame:
        """Energy price ($/kWh), load and generation (per unit of peak) by interval, `profile.csv`.

        Examples
        --------
        >>> import evdash
        >>> float(evdash.load("price-spike").profile.price_per_kwh.max())
        1.557426
        """
        return frame(domain.ProfileRow, self.data.profile)

    @property
    def arrivals(self) -> pd.DataFrame:
        """Who comes: the vehicles on file, or those the seed draws, as `arrivals.csv`."""
        return frame(Arrival, arrivals_of(self.data))

    @property
    def events(self) -> pd.DataFrame:
        """What happens on the way, `events.csv`."""
        return frame(Event, self.data.events)

    def replace(self, settings: Mapping[str, object]) -> "Scenario":
        """Exchange settings.

        Parameters
        ----------
        settings : mapping
            Keys of ``scenario.toml``, such as ``station.chargers`` or
            ``option.C1.price_per_kwh``, and those a study may vary (docs/studies.md).

        Returns
        -------
        Scenario
            Another scenario; this one stays as it is.

        Raises
        ------
        InputError
            With every key that does not exist and every value that will not do.

        Examples
        --------
        >>> import evdash
        >>> day = evdash.load().replace({"station.chargers": 2, "arrivals.seed": 7})
        >>> day.data.station.chargers
        2
        >>> day.replace({"station.chargers": -1})
        Traceback (most recent call last):
        ...
        evdash.errors.InputError: station.chargers: found -1; should be at least 0 (How many ...
        """
        return Scenario(with_settings(self.data, settings))

    def replace_table(self, name: str, table: pd.DataFrame) -> "Scenario":
        """Exchange a table, such as prices of your own, arrivals, or events on the way.

        Parameters
        ----------
        name : {"nodes", "lines", "profile", "arrivals", "fleet", "events"}
            Which; where arrivals were drawn, those given stand in their place from now on.
        table : pandas.DataFrame
            With the columns of that file (docs/scenario.md); what is missing in a cell is blank.

        Returns
        -------
        Scenario
            Another scenario; this one stays as it is.

        Raises
        ------
        InputError
            With every fault, by row and column, as of a file.

        Examples
        --------
        >>> import evdash
        >>> scenario = evdash.load("summer-weekday")
        >>> dearer = scenario.profile.assign(price_per_kwh=lambda rows: 2 * rows.price_per_kwh)
        >>> float(scenario.replace_table("profile", dearer).profile.price_per_kwh.max())
        0.131084
        """
        known, file = self.data, f"{name}.csv"
        if file not in FILE_NAMES:
            tables = ", ".join(one.removesuffix(".csv") for one in FILE_NAMES if one != SETTINGS)
            raise InputError([Fault("name", repr(name), f"should be one of {tables}")])
        if name == "arrivals":
            known = resolved(known, arrivals_of(known))
        text = table.to_csv(index=False, date_format=LOCAL_TIME_FORMAT)
        files = scenario_files(known) | {file: text}
        return Scenario(parse_scenario({name: text.encode() for name, text in files.items()}))

    def save(self, file: str | Path) -> None:
        """Write the scenario as a ``.zip`` that `load`, the command line and the app read.

        Parameters
        ----------
        file : str or Path
            Its place; what is there is replaced.

        Raises
        ------
        InputError
            For a name that does not end in ``.zip``, or a place that cannot be written.
        """
        path = Path(file)
        if path.suffix != ".zip":
            raise InputError([Fault("file", repr(path.name), "should end in .zip")])
        put_files({path: zipped(scenario_files(self.data))})

    def run(
        self,
        policy: str | Own = "p1",
        *,
        seed: int | None = None,
        network: Network = "lindistflow",
    ) -> Day:
        """Run the whole day, interval by interval.

        Parameters
        ----------
        policy : str or callable, default "p1"
            Who decides, by the names of ``--policy``, or a function of your own that takes an
            `evdash.domain.plan.Snapshot` and answers who gets how much power when
            (docs/policies.md). Its plans are certified as those of ours are: where one breaks a
            limit or a promise, or there is none, the last is kept and the fault told.
        seed : int, optional
            Seed of the random arrivals in place of the scenario's.
        network : {"lindistflow", "ac"}
            Model of the feeder whose limits are kept.

        Returns
        -------
        Day

        Raises
        ------
        InputError
            For a policy, seed or network model there is none of.

        Examples
        --------
        >>> import evdash
        >>> day = evdash.load("summer-weekday").run(policy="p1", seed=3)
        >>> day.is_sound
        True
        """
        scenario, rule = self._seeded(seed), rule_of(policy)
        check_network(network)
        began = time.perf_counter()
        trace = start_day(scenario, network, rule.name)
        trace = run_day(trace, rule.make(trace.inputs), decide=rule.decide)
        seconds = time.perf_counter() - began
        return Day(trace, RunLabel(rule.name, network, scenario.arrivals.seed, seconds))

    def race(
        self,
        policies: Sequence[str | Own] = CONTESTANTS,
        *,
        seed: int | None = None,
        network: Network = "lindistflow",
    ) -> Race:
        """Race policies on this day, with the same arrivals and events for all.

        Parameters
        ----------
        policies : sequence of str or callable
            Who takes part, as for `run`; by default all of ours but ``p1-plain``.
        seed, network
            As for `run`.

        Returns
        -------
        Race

        Raises
        ------
        InputError
            For a policy, seed or network model there is none of.

        Examples
        --------
        >>> import evdash
        >>> race = evdash.load("price-spike").race(["p1", "fcfs"])
        >>> race.figures[["profit", "broken"]].round(2)
                profit  broken
        policy
        p1       77.26       0
        fcfs   -410.87       0
        """
        rules = rules_of(policies)
        check_network(network)
        inputs = prepare(self._seeded(seed), network)
        return Race(race(inputs, rules, find=rules.__getitem__))

    def study(
        self,
        axes: Mapping[str, Sequence[object]],
        *,
        days: int | None = 20,
        policies: Sequence[str] = ("p1",),
        networks: Sequence[Network] = ("lindistflow",),
        metrics: Sequence[str] = METRICS,
        folder: str | Path | None = None,
        workers: int = 0,
    ) -> Study:
        """Run this day many times over, with other settings and random arrivals.

        Parameters
        ----------
        axes : mapping
            Values by key, of which every combination is run: ``{"station.chargers": [6, 12]}``;
            none, ``{}``: the day as it is.
        days : int or None, default 20
            Days drawn at every point, a seed each; None: the scenario's own arrivals alone.
        policies, networks : sequence of str
            Who decides, by the names of ``--policy``, and the network models whose limits are kept.
        metrics : sequence of str
            Columns of the tables, of those in docs/studies.md.
        folder : str or Path, optional
            Where results land one by one, to be resumed or extended by the same call; without
            one they are kept in memory alone.
        workers : int, default 0
            Processes; 0: one for every core.

        Returns
        -------
        Study

        Raises
        ------
        InputError
            With every fault in what is to be varied, or for a folder that cannot be used.

        Examples
        --------
        >>> import evdash
        >>> study = evdash.load().study({"station.chargers": [2, 4]}, days=2, workers=1)
        >>> study.summary.query("metric == 'admitted'")[["station.chargers", "days", "p50"]]
           station.chargers  days   p50
        1                 2     2  13.0
        6                 4     2  26.0
        """
        form = {
            "format": 1,
            "name": self.data.name,
            "axis": [{"key": key, "values": list(values)} for key, values in axes.items()],
            "seeds": None if days is None else {"count": days},
            "policies": tuple(policies),
            "networks": tuple(networks),
            "metrics": tuple(metrics),
        }
        check_some(policies)
        all_given(policies, "policies")
        return run_here(lay_out(study_of(form), self.data, tuple(policies)), folder, workers)

    def _seeded(self, seed: int | None) -> domain.Scenario:
        return self.data if seed is None else with_settings(self.data, {"arrivals.seed": seed})
