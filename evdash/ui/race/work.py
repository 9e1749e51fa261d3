"""A race in a process of its own, so that nobody else's page waits for it. No Streamlit in here.

`python -m evdash.ui.race.work FOLDER QUEUE NETWORK NAME …` races the policies on FOLDER/scenario,
one race of all that share the file QUEUE at a time; how far it is stands in FOLDER/stand.json,
and in the end the race in FOLDER/race.json.
"""

import json
import os
import sys
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Literal

from filelock import FileLock

from evdash.domain.trace import Network
from evdash.errors import EvdashError
from evdash.files.exchange import output_folder
from evdash.files.nested import read_json
from evdash.files.race_folder import RACE, is_race, write_race
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.inputs import prepare
from evdash.policies.race import Told, race

NICENESS = 5
NO_TURN = (
    "Races take turns by a file that cannot be opened, as when another user of this computer has "
    "begun it; whoever owns it may delete it:"
)
SCENARIO, STAND = "scenario", "stand.json"
State = Literal["waiting", "running", "done", "broken"]


@dataclass(frozen=True, slots=True)
class Stand:
    """How a race stands; `said` is why it broke."""

    state: State
    policy: str = ""
    done: int = 0
    total: int = 0
    said: str = ""


def read_stand(folder: Path) -> Stand:
    """How the race in a folder stands; waiting while nothing is said."""
    try:
        return Stand(**read_json((folder / STAND).read_text(encoding="utf-8")))
    except (OSError, ValueError, TypeError):
        return Stand("waiting")


def write_stand(folder: Path, stand: Stand) -> None:
    """Say how it stands, at once or not at all."""
    beside = folder / f"{STAND}.new"
    beside.write_text(json.dumps(asdict(stand)), encoding="utf-8")
    beside.replace(folder / STAND)


def main(folder: Path, queue: Path, network: Network, policies: list[str]) -> None:
    """Wait for a turn and race; what becomes of it stands in the folder."""
    if hasattr(os, "nice"):
        os.nice(NICENESS)
    write_stand(folder, Stand("waiting"))
    try:
        turn = FileLock(queue).acquire()
    except OSError as error:
        write_stand(folder, Stand("broken", said=f"{NO_TURN} {queue}: {error.strerror}."))
        return
    with turn:
        write_stand(folder, Stand("running"))
        try:
            inputs = prepare(read_scenario(folder / SCENARIO), network)
            found = race(inputs, policies, lambda now: write_stand(folder, _running(now)))
            with output_folder(folder / RACE.removesuffix(".json"), "race", is_race, True) as out:
                write_race(out, found)
        except EvdashError as error:
            write_stand(folder, Stand("broken", said=str(error)))
        except Exception as error:
            write_stand(folder, Stand("broken", said=f"{type(error).__name__}: {error}"))
            raise
        else:
            write_stand(folder, Stand("done"))


def _running(now: Told) -> Stand:
    return Stand("running", now.policy, now.done, now.total)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]), sys.argv[3], sys.argv[4:])  # type: ignore[arg-type]
