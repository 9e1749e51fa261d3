"""A race as files: figures by policy, every interval, and the whole of it as JSON."""

from pathlib import Path

from pydantic import TypeAdapter, ValidationError

from evdash.errors import Fault, InputError
from evdash.files.tables import write_table
from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service
from evdash.policies.race import Lap, Race

RACE, POLICIES, INTERVALS = "race.json", "policies.csv", "intervals.csv"
REFUSALS = "refusals.csv"
FORM = TypeAdapter(Race)


def race_files(race: Race) -> dict[str, str]:
    """Every file of a race, name to text."""
    return {
        RACE: FORM.dump_json(race, indent=1).decode() + "\n",
        POLICIES: policies_text(race),
        INTERVALS: intervals_text(race),
        REFUSALS: refusals_text(race),
    }


def policies_text(race: Race) -> str:
    """A row for each policy, a column for each figure; shares from 0 to 1, units in the head."""
    options = sorted({option for lap in race.laps for option in lap.service.acceptance_by_option})
    figures = figures_of(Service)
    head = ["policy", *(f.name for f in figures), *(f"acceptance_{option}" for option in options)]
    return write_table(head, (_row(lap, options) for lap in race.laps))


def _row(lap: Lap, options: list[str]) -> list[object]:
    figures = (getattr(lap.service, figure.name) for figure in figures_of(Service))
    by_option = (lap.service.acceptance_by_option.get(option) for option in options)
    return [lap.policy, *figures, *by_option]


def intervals_text(race: Race) -> str:
    """A row for each interval and policy."""
    head = ["interval", "start", "policy", "station_kw", "headroom_kw"]
    head += ["admitted", "refused", "lowest_ac_pu", "capacity_price_per_kwh"]
    return write_table(
        head,
        (
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
        ),
    )


def refusals_text(race: Race) -> str:
    """A row for everyone a policy refused, with the reason it gave."""
    head = ["policy", "interval", "start", "vehicle", "option", "need_kwh", "reason"]
    return write_table(
        head,
        (
            [
                lap.policy,
                one.interval,
                f"{race.times[one.interval]:%Y-%m-%dT%H:%M}",
                one.vehicle,
                one.option,
                one.need_kwh,
                one.reason,
            ]
            for lap in race.laps
            for one in lap.turned_down
        ),
    )


def read_race(file: Path) -> Race:
    """A race back from its JSON; raises InputError if it is none."""
    try:
        return FORM.validate_json(file.read_bytes())
    except (OSError, ValidationError) as error:
        fault = Fault(str(file), "no race that can be read", "should be written by `evdash race`")
        raise InputError([fault]) from error


def check_place(directory: Path, force: bool) -> None:
    """Refuse a place that must not be written to, before any work is done."""
    place = f"--out {directory}"
    if not directory.exists():
        return
    if not directory.is_dir():
        raise InputError([Fault(place, "a file", "should be a folder")])
    there = {path.name for path in directory.iterdir()}
    if there - {RACE, POLICIES, INTERVALS, REFUSALS}:
        allowed = "should be new, empty, or an earlier race's"
        raise InputError([Fault(place, "a folder with other things in it", allowed)])
    if there and not force:
        raise InputError([Fault(place, "an earlier race", "add --force to replace it")])


def write_race(directory: Path, race: Race) -> None:
    """Write a race's files."""
    try:
        directory.mkdir(parents=True, exist_ok=True)
        for name, text in race_files(race).items():
            (directory / name).write_text(text, encoding="utf-8", newline="")
    except OSError as error:
        fault = Fault(f"--out {directory}", f"a place that cannot be written ({error})", "writable")
        raise InputError([fault]) from error
