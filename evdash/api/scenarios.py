"""A scenario on its way into a day, a race or a study."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas as pd

from evdash.api.days import Day
from evdash.api.races import Race
from evdash.api.studies import Study, run_here
from evdash.domain import scenario as domain
from evdash.domain.plan import Snapshot
from evdash.domain.study import Study as StudyForm
from evdash.domain.trace import Network
from evdash.errors import Fault, InputError
from evdash.files.bundled import located
from evdash.files.frames import frame
from evdash.files.run_export import RunLabel
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.arrivals import arrivals_of
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.horizon.networks import NETWORKS
from evdash.policies.race import CONTESTANTS, race
from evdash.policies.registry import Rule, all_given, given, own
from evdash.studies.keys import with_settings
from evdash.studies.reading import lay_out, study_of

METRICS = StudyForm.model_fields["metrics"].default
Own = Callable[[Snapshot], object]
"""A policy of somebody's own: it answers a mapping from vehicle to power in kW, or a Plan."""


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
    scenario = Scenario(read_scenario(located(source)))
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
        return frame(domain.Arrival, arrivals_of(self.data))

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
        scenario, rule = self._seeded(seed), _rule(policy)
        _check_network(network)
        began = time.perf_counter()
        trace = start_day(scenario, network)
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
        rules = _rules(policies)
        _check_network(network)
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
            Values by key, of which every combination is run: ``{"station.chargers": [6, 12]}``.
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
        all_given(policies, "policies")
        return run_here(lay_out(study_of(form), self.data, tuple(policies)), folder, workers)

    def _seeded(self, seed: int | None) -> domain.Scenario:
        return self.data if seed is None else with_settings(self.data, {"arrivals.seed": seed})


def _rule(policy: str | Own) -> Rule:
    """A policy by its name, or one of somebody's own, whose plans are certified like ours."""
    return given(policy, "policy") if isinstance(policy, str) else own(policy)


def _rules(policies: Sequence[str | Own]) -> dict[str, Rule]:
    """Policies that are to race, each under a name of its own."""
    rules: dict[str, Rule] = {}
    for policy in policies:
        rule = _rule(policy)
        if rule.name in rules and not isinstance(policy, str):
            allowed = "should have names that tell them apart"
            raise InputError([Fault("policies", f"two functions called {rule.name}", allowed)])
        rules[rule.name] = rule
    return rules


def _check_network(network: str) -> None:
    if network not in NETWORKS:
        rule = f"should be one of {', '.join(NETWORKS)}"
        raise InputError([Fault("network", repr(network), rule)])
