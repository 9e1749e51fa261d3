"""What the audit works out and what it takes on trust: one declaration.

From here come the words of the audit's output and the table of `docs/reliability.md`, and the
test that falsifies every column and key asks here which of them may pass unseen.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

Standing = Literal["worked out", "held", "on trust"]
MEANING: dict[Standing, str] = {
    "worked out": "worked out again",
    "held": "held within what the other files allow, not worked out",
    "on trust": "taken on trust",
}


@dataclass(frozen=True, slots=True)
class Entry:
    """Columns of a table, or keys of `summary.json`, that stand alike, and how.

    `how` says by what they are worked out or held, or why they are taken on trust.
    """

    file: str
    names: tuple[str, ...]
    standing: Standing
    how: str


def _entry(file: str, names: str, standing: Standing, how: str) -> Entry:
    return Entry(file, tuple(names.split()), standing, how)


COVERAGE: tuple[Entry, ...] = (
    _entry(
        "intervals.csv",
        "interval start price_per_kwh",
        "worked out",
        "from the scenario's clock, prices and events",
    ),
    _entry(
        "intervals.csv",
        "arrived admitted refused charging station_kw",
        "worked out",
        "counted and summed from `vehicles.csv` and `power.csv`",
    ),
    _entry(
        "intervals.csv",
        "headroom_kw binding",
        "worked out",
        "no limit is worsened up to it, and the element named is 0.1 % and 0.05 kW beyond it (1 % "
        "short of a voltage collapse); where blank, none is at any power; where the feeder is "
        "beyond several limits by itself, the element named is one of them",
    ),
    _entry(
        "intervals.csv",
        "objective bound status",
        "held",
        "bound at most the objective, optimal if and only if within a cent of it, blank where P1 "
        "is not solved; objective between what its neighbours and the executed day leave "
        "possible; proven anew by `--optimum`",
    ),
    _entry("intervals.csv", "solve_seconds", "on trust", "nobody else saw that clock"),
    _entry(
        "vehicles.csv",
        "vehicle option arrival_interval need_kwh deadline_interval",
        "worked out",
        "from the scenario's arrivals, options and station",
    ),
    _entry(
        "vehicles.csv",
        "status delivered_kwh completed_interval revenue",
        "worked out",
        "from the need, `power.csv` and drivers' events",
    ),
    _entry(
        "vehicles.csv",
        "reason",
        "held",
        "there if and only if refused, and one that the policy gives; worked out are what no "
        "schedule could serve, energy that costs what it pays, a feeder that cannot carry it "
        "alone and a plan kept for want of another; between the other reasons, and in their "
        "figures, it is taken on trust",
    ),
    _entry(
        "ledger.csv",
        "vehicle option promised_kwh promised_by_interval delivered_kwh short_kwh status",
        "worked out",
        "from `vehicles.csv`; what is short from what was last agreed",
    ),
    _entry(
        "ledger.csv",
        "revised_kwh released_kwh",
        "worked out",
        "they make up the promise; where a driver both asked for more and gave something up, to "
        "within what was asked for",
    ),
    _entry("ledger.csv", "revised_by_interval", "worked out", "from the driver's own events"),
    _entry(
        "ledger.csv",
        "since_interval cause",
        "held",
        "to the events, in order, that came while the contract was open and could change it; "
        "which of several did is taken on trust",
    ),
    _entry(
        "power.csv",
        "interval vehicle power_kw",
        "worked out",
        "it keeps every promise, every charger's range, all times, chargers and limits, and "
        "makes up the other files' energy and power",
    ),
    _entry(
        "voltages.csv",
        "interval node voltage_pu",
        "worked out",
        "by walking the feeder, linearised",
    ),
    _entry("voltages.csv", "voltage_ac_pu", "worked out", "by pandapower"),
    _entry(
        "summary.json",
        "arrived admitted refused charged broken released energy_requested_kwh "
        "energy_delivered_kwh revenue energy_cost peak_station_kw profit intervals "
        "optimal_intervals fallback_intervals",
        "worked out",
        "from the tables",
    ),
    _entry(
        "summary.json",
        "limits_broken_by_station limits_broken_by_feeder ac_limits_broken_by_station "
        "ac_limits_broken_by_feeder ac_without_solution worst_voltage_error_pu",
        "worked out",
        "from `power.csv`, linearised and by pandapower",
    ),
    _entry(
        "summary.json",
        "scenario seed scenario_sha256 format",
        "worked out",
        "from `scenario/`",
    ),
    _entry(
        "summary.json",
        "network",
        "worked out",
        "headroom is held against the model it names",
    ),
    _entry(
        "summary.json",
        "policy",
        "held",
        "a policy there is, and P1's if and only if there is an objective; which one it is, is "
        "taken on trust",
    ),
    _entry(
        "summary.json",
        "wall_seconds versions",
        "on trust",
        "nobody else saw that clock and machine",
    ),
    _entry(
        "explanations.csv",
        "vehicle",
        "worked out",
        "everyone refused, once, in the order of `vehicles.csv`",
    ),
    _entry(
        "explanations.csv",
        "cause",
        "held",
        "to the kind of reason in `vehicles.csv`",
    ),
    _entry(
        "explanations.csv",
        "detail remedy",
        "on trust",
        "found by solving days that were not",
    ),
    _entry(
        "worths.csv",
        "change profit admitted energy_kwh",
        "on trust",
        "found by running days that were not",
    ),
    _entry("binding.csv", "element interval tightest", "worked out", "from `intervals.csv`"),
    _entry(
        "binding.csv",
        "reached",
        "held",
        "worked out for chargers and the tightest element; of another only that the station "
        "drew that much",
    ),
    _entry("revisions.csv", "interval", "worked out", "every interval but the first, in order"),
    _entry(
        "revisions.csv",
        "moved_kwh for_newcomers_kwh cost_change told",
        "on trust",
        "plans are in no file",
    ),
    _entry(
        "scenario/",
        "*",
        "worked out",
        "every file but `README.md` by the hash in `summary.json`",
    ),
)
SUMMARY_KEYS = tuple(
    name for entry in COVERAGE if entry.file == "summary.json" for name in entry.names
)


def standing_of(file: str, name: str) -> Standing:
    """How a column or key stands; raises KeyError for one that is not declared."""
    for entry in COVERAGE:
        if entry.file == file and name in entry.names:
            return entry.standing
    raise KeyError(f"{file}, {name}")


def told_of(files: frozenset[str], standing: Standing) -> str:
    """Which columns and keys of the files there are stand so, in words."""
    named: dict[str, list[str]] = {}
    for entry in COVERAGE:
        if entry.file in files and entry.standing == standing:
            named.setdefault(entry.file, []).extend(entry.names)
    return "; ".join(f"{file}: {', '.join(names)}" for file, names in named.items())


def coverage_table() -> Iterator[str]:
    """The whole declaration as lines of a Markdown table."""
    yield "| file | columns, keys | the audit | how, or why not |"
    yield "| --- | --- | --- | --- |"
    for entry in COVERAGE:
        names = ", ".join(f"`{name}`" for name in entry.names).replace("`*`", "all")
        yield f"| `{entry.file}` | {names} | {MEANING[entry.standing]} | {entry.how} |"
