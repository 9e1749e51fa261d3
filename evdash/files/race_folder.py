"""A race as files: figures by policy, every interval, and the whole of it as JSON."""

from collections.abc import Callable, Iterator
from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from evdash.errors import Fault, InputError
from evdash.files.exchange import Claim
from evdash.files.tables import write_table
from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service
from evdash.policies.race import Lap, Race

RACE, POLICIES, INTERVALS = "race.json", "policies.csv", "intervals.csv"
REFUSALS = "refusals.csv"
RACE_FILES = (RACE, POLICIES, INTERVALS, REFUSALS)
FORM = TypeAdapter(Race)
Table = tuple[list[str], Iterator[list[object]]]
"""The head and the rows of a table."""
Tabled = Callable[[Race], Table]


def race_files(race: Race) -> dict[str, str]:
    """Every file of a race, name to text."""
    return {
        RACE: FORM.dump_json(race, indent=1).decode() + "\n",
        POLICIES: write_table(*policies_table(race)),
        INTERVALS: write_table(*intervals_table(race)),
        REFUSALS: write_table(*refusals_table(race)),
    }


def policies_table(race: Race) -> Table:
    """A row for each policy, a column for each figure; shares from 0 to 1, units in the head."""
    options = sorted({option for lap in race.laps for option in lap.service.acceptance_by_option})
    figures = figures_of(Service)
    head = ["policy", *(f.name for f in figures), *(f"acceptance_{option}" for option in options)]
    return head, (_row(lap, options) for lap in race.laps)


def _row(lap: Lap, options: list[str]) -> list[object]:
    figures = (getattr(lap.service, figure.name) for figure in figures_of(Service))
    by_option = (lap.service.acceptance_by_option.get(option) for option in options)
    return [lap.policy, *figures, *by_option]


def intervals_table(race: Race) -> Table:
    """A row for each interval and policy."""
    head = ["interval", "start", "policy", "station_kw", "headroom_kw"]
    head += ["admitted", "refused", "lowest_ac_pu", "capacity_price_per_kwh"]
    return head, (
        [
            t,
            f"{race.times[t]:%Y-%m-%dT%H:%M}",
            lap.policy,
            lap.station_kw[t],
            race.headroom_kw[t],
            lap.admitted[t],
            lap.refused[t],
            lap.lowest_ac_pu[t],
            lap.capacity_price_per_kwh[t],
        ]
        for t in range(len(race.headroom_kw))
        for lap in race.laps
    )


def refusals_table(race: Race) -> Table:
    """A row for everyone a policy refused, with the reason it gave."""
    head = ["policy", "interval", "start", "vehicle", "option", "need_kwh", "reason"]
    return head, (
        [
            lap.policy,
            one.interval,
            f"{race.times[one.interval]:%Y-%m-%dT%H:%M}",
            one.vehicle,
            one.option,
            one.need_kwh,
            str(one.reason),
        ]
        for lap in race.laps
        for one in lap.turned_down
    )


def read_race(file: Path) -> Race:
    """A race back from its JSON; raises InputError if it is none."""
    try:
        return FORM.validate_json(file.read_bytes())
    except (OSError, ValidationError) as error:
        fault = Fault(str(file), "no race that can be read", "should be written by `evdash race`")
        raise InputError([fault]) from error


def write_race(claim: Claim, race: Race) -> None:
    """Put a race's files in place of an earlier race's; what else lies there stays as it is."""
    claim.replace(race_files(race), own=RACE_FILES, last=RACE)


def is_race(directory: Path) -> bool:
    """Whether a folder holds a race."""
    return (directory / RACE).is_file()
