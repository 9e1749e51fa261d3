"""A study: the same day many times over, with other settings, policies or random arrivals.

Fields are those of a study file (`docs/studies.md`), each declared once. What they must agree
on, and whether every point is a valid scenario, is checked in `evdash.studies.reading`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from evdash.domain.fields import (
    Count,
    Name,
    Record,
    Title,
    declare,
    declare_default,
    declare_optional,
)
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network

MOST_POINTS, MOST_RUNS = 5_000, 1_000_000
ALL_NODES = "all"
"""In place of values of `station.node`: every node but the source."""


def _flat(value: object) -> object:
    """Nested tables as one with dotted keys: `[set.station] chargers = 8` is `station.chargers`."""
    return dict(_leaves("", value)) if isinstance(value, Mapping) else value


def _leaves(key: str, value: object) -> Iterator[tuple[str, object]]:
    if not isinstance(value, Mapping):
        yield key, value
        return
    for part, inner in value.items():
        yield from _leaves(f"{key}.{part}" if key else f"{part}", inner)


def _one(value: object) -> object:
    if type(value) is not int or value != 1:
        raise ValueError("should be 1")
    return value


Settings = Annotated[dict[str, Any], BeforeValidator(_flat)]
"""Values by key: keys of scenario.toml as in `--set`, and those of `docs/studies.md` besides."""


class Case(Record):
    """One `[[axis.case]]`: several settings that change together, under a name."""

    name: Name = declare("What the case is called in tables and pictures", "", "two more")
    set: Settings = declare_default("Values by key; empty: as in the base scenario", "", {})


class Axis(Record):
    """One `[[axis]]`: what is varied. Either `key` with `values`, or cases."""

    name: Name | None = declare_optional("Heading of its column; left out: the key", "")
    key: str | None = declare_optional("Key whose value is varied", "")
    values: tuple[Any, ...] | Literal["all"] = declare_default(
        'Values it takes; for `station.node` also "all": every node but the source', "", ()
    )
    case: tuple[Case, ...] = declare_default("Cases, in place of key and values", "", ())

    @property
    def title(self) -> str:
        """The heading of its column."""
        return self.name or self.key or "case"


class Seeds(Record):
    """The `[seeds]` table: how many days are drawn at every point, and from which seed on."""

    first: Count = declare_default("Seed of the first day", "", 1, ge=0, le=2**62)
    count: Count = declare("Days at every point, a seed each", "days", 20, ge=1, le=100_000)


class Study(Record):
    """A study file."""

    format: Annotated[Literal[1], BeforeValidator(_one)] = declare(
        "Version of the study form", "", 1
    )
    name: Title = declare("Name of the study", "", "study")
    question: str = declare_default("What it is to answer, in a sentence", "", "", max_length=1000)
    base: str = declare_default(
        "Base scenario: a folder or .zip, seen from the study file, or the name of a bundled one",
        "",
        "summer-weekday",
        min_length=1,
    )
    set: Settings = declare_default("Settings laid over the base scenario, by key", "", {})
    seeds: Seeds | None = declare_optional(
        "Days drawn at every point; left out: the scenario's own arrivals alone", ""
    )
    policies: tuple[str, ...] = declare_default(
        "Who decides, by the names of `--policy`", "", ("p1",), min_length=1
    )
    networks: tuple[Network, ...] = declare_default(
        "Network models whose limits are kept", "", ("lindistflow",), min_length=1
    )
    metrics: tuple[str, ...] = declare_default(
        "Columns of the tables, from the list of metrics",
        "",
        ("profit", "admitted", "acceptance", "peak_station_kw", "least_headroom_kw"),
        min_length=1,
    )
    referee_every: Count = declare_default(
        "One run in so many is solved by pandapower, too; 0: none", "runs", 50, ge=0, le=1_000_000
    )
    axis: tuple[Axis, ...] = declare_default(
        "What is varied; every combination is run", "", (), max_length=6
    )


@dataclass(frozen=True, slots=True)
class Point:
    """One combination of the axes' values: its label on every axis and the settings it stands
    for. `digest` is of the scenario they give."""

    labels: tuple[object, ...]
    settings: Settings
    digest: str


@dataclass(frozen=True, slots=True)
class Run:
    """One day of a study. `key` tells it from every other; `referee`: its AC voltages are held
    against pandapower's, too."""

    key: str
    point: int
    policy: str
    network: Network
    seed: int | None
    referee: bool


@dataclass(frozen=True, slots=True)
class StudyRuns:
    """A study ready to run: every point checked, and the runs in the order of its tables.

    `given` is the base scenario as read, `base` the same with the study's own settings.
    """

    study: Study
    given: Scenario
    base: Scenario
    points: tuple[Point, ...]
    runs: tuple[Run, ...]

    @property
    def axes(self) -> tuple[str, ...]:
        """The headings of the axes' columns."""
        return tuple(axis.title for axis in self.study.axis)


Status = Literal["done", "failed"]
Figure = float | str | None
Figures = Mapping[str, Figure]
"""What a day came to, by the names of `evdash.studies.measures`."""


@dataclass(frozen=True, slots=True)
class Result:
    """What came of a run; `reason` says why it failed, `seconds` is processor time."""

    key: str
    status: Status
    reason: str
    figures: Figures
    seconds: float


@dataclass(frozen=True, slots=True)
class Band:
    """A metric over the seeds of one group of runs: quantiles, mean and its standard error.

    Of `days` days. `group` are the labels of the axes, then policy and network model.
    """

    group: tuple[object, ...]
    metric: str
    days: int
    mean: float
    error: float | None
    p05: float
    p50: float
    p95: float
