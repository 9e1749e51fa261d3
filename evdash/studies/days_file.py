"""Days run with many seeds as a file: what was measured, on which machine, with which versions."""

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from datetime import date
from pathlib import Path

from evdash.domain.scenario import Scenario
from evdash.files.run_export import versions
from evdash.files.run_folder import scenario_hash
from evdash.files.scenario_folder import scenario_files
from evdash.resources import DATA
from evdash.studies.days import DayTaken

PAPER_DAYS = DATA / "results" / "paper_days.json"


@dataclass(frozen=True, slots=True)
class MeasuredDays:
    """Days measured once: when, of which scenario, on what, and each of them.

    `note` says what else may have borne on the times.
    """

    made_by: str
    note: str
    made_on: str
    scenario: str
    scenario_sha256: str
    machine: dict[str, str]
    versions: dict[str, str]
    days: tuple[DayTaken, ...]


def measured(
    scenario: Scenario, days: Sequence[DayTaken], made_by: str, note: str = ""
) -> MeasuredDays:
    """Days just run on this machine."""
    files = {name: text.encode() for name, text in scenario_files(scenario).items()}
    return MeasuredDays(
        made_by=made_by,
        note=note,
        made_on=date.today().isoformat(),
        scenario=scenario.name,
        scenario_sha256=scenario_hash(files),
        machine={
            "processor": processor(),
            "cores": str(os.cpu_count()),
            "system": f"{platform.system()} {platform.machine()}",
        },
        versions=versions(),
        days=tuple(days),
    )


def processor() -> str:
    """What the machine calls its processor."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return platform.processor() or "unknown"
    names = [line.partition(":")[2].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or "unknown"


def days_text(days: MeasuredDays) -> str:
    """The file's text."""
    return json.dumps(asdict(days), indent=1) + "\n"


def read_days(path: Path = PAPER_DAYS) -> MeasuredDays:
    """Days measured before."""
    said = json.loads(path.read_text(encoding="utf-8"))
    return MeasuredDays(**{**said, "days": tuple(DayTaken(**day) for day in said["days"])})
