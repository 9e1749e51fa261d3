"""Days that tell whose they are: scenario, vehicles and node carry their owner's mark."""

import re
from pathlib import Path

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario, resolved
from evdash.horizon.arrivals import arrivals_of
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from evdash.store.journal import Journal
from evdash.store.parts import Kept
from evdash.store.runs import Store

MARK = re.compile(rb"Visitor(\d{4})x")


def mark_of(number: int) -> str:
    """What nobody else's data holds."""
    return f"Visitor{number:04d}x"


def day_of(number: int, vehicles_per_day: float = 100.0) -> Scenario:
    """The bundled day with arrivals of its own, everything named for its owner."""
    settings = {"arrivals.seed": number, "arrivals.vehicles_per_day": vehicles_per_day}
    drawn = edit_scenario(read_scenario(DEFAULT), settings)
    vehicles = tuple(
        one.model_copy(update={"vehicle": f"{mark_of(number)}-{n:03d}"})
        for n, one in enumerate(arrivals_of(drawn), 1)
    )
    own = resolved(drawn, vehicles)
    known = own.arrivals
    if not isinstance(known, RecordedArrivals):
        raise TypeError("arrivals that were drawn are records")
    node, own_node = own.station.node, f"{mark_of(number)}-{own.station.node}"
    return own.replacing(
        name=f"Day of {mark_of(number)}",
        arrivals=known.model_copy(update={"vehicles": vehicles}),
        station=own.station.model_copy(update={"node": own_node}),
        nodes=tuple(
            one.model_copy(update={"node": own_node}) if one.node == node else one
            for one in own.nodes
        ),
        lines=tuple(
            one.model_copy(
                update={
                    end: own_node for end in ("from_node", "to_node") if getattr(one, end) == node
                }
            )
            for one in own.lines
        ),
    )


def kept_in(directory: Path, scenario: Scenario) -> str:
    """The day kept in a store, not begun; the link it is opened with."""
    journal = Journal(Store(directory))
    journal.keep(Kept("", scenario, start_day(scenario)))
    journal.store.database.close()
    return journal.link


def steps_kept(directory: Path, link: str) -> int | None:
    """How many steps of a link's run are kept; None where there is no such run."""
    store = Store(directory)
    found = Journal.resume(store, link)
    store.database.close()
    return None if found is None else len(found[1].trace.steps)


def is_as_decided_alone(directory: Path, link: str, scenario: Scenario) -> bool:
    """Whether a kept run is what the same day gives, stepped as often, with nobody else around."""
    store = Store(directory)
    found = Journal.resume(store, link)
    store.database.close()
    if found is None:
        return False
    steps = found[1].trace.steps
    alone = run_day(start_day(scenario), p1_policy()).steps[: len(steps)]
    return all(
        ours.plan.vehicles == theirs.plan.vehicles
        and ours.plan.admitted == theirs.plan.admitted
        and ours.plan.power_kw.tobytes() == theirs.plan.power_kw.tobytes()
        for ours, theirs in zip(alone, steps, strict=True)
    )
