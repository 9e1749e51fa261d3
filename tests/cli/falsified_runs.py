"""Runs whose files the tests falsify: of every policy, model and kind of day that matters."""

from collections.abc import Callable
from pathlib import Path

from benchmarks.audited import write
from evdash.cli.main import main
from evdash.domain.plan import Plan, Snapshot
from evdash.domain.trace import Trace
from evdash.errors import SolverFailure
from evdash.files.scenario_folder import scenario_files
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy
from tests.builders import PRESETS, line, make_scenario, node, vehicle
from tests.cli.test_events import BREAKING, DRIVERS


def folder_of(scenario, place: Path, events: str = "") -> Path:
    place.mkdir(parents=True)
    for name, text in scenario_files(scenario).items():
        (place / name).write_text(text, encoding="utf-8", newline="")
    if events:
        (place / "events.csv").write_text(events, encoding="utf-8")
    return place


def outside():
    """A feeder beyond its limits by itself in one interval, without AC solution in another."""
    return make_scenario(
        name="outside",
        nodes=[node("s"), node("a", load_kw=400, generation_kw=900), node("b", load_kw=20)],
        lines=[line("s", "a", rating=300.0), line("a", "b", r=0.4)],
        price=(0.1, 0.3, 0.2, 0.05),
        load=(0.2, 1.1, 90.0, 0.2),
        generation=(1.0, 0.0, 0.0, 0.4),
        vehicles=[vehicle(f"V{n}", n / 3, need_kwh=9 + n) for n in range(9)],
    )


def with_a_lost_solver() -> Trace:
    """A day in which P1's solver is lost twice, once while somebody asks."""
    scenario = make_scenario(
        name="lost",
        nodes=[node("s"), node("a", load_kw=40)],
        lines=[line("s", "a", rating=90.0)],
        price=(0.1, 0.3, 0.2, 0.05, 0.1, 0.2),
        vehicles=[vehicle(f"V{n}", n / 3, need_kwh=12 + n) for n in range(12)],
    )
    solve = p1_policy()

    def policy(snapshot: Snapshot) -> Plan:
        if snapshot.now in (1, 4):
            raise SolverFailure("lost on purpose")
        return solve(snapshot)

    return run_day(start_day(scenario), policy)


def small():
    return make_scenario(
        name="small",
        nodes=[node("s"), node("a", load_kw=40), node("b", load_kw=20)],
        lines=[line("s", "a", rating=90.0), line("a", "b")],
        price=(0.1, 0.3, 0.2, 0.05),
        vehicles=[vehicle(f"V{n}", n / 4, need_kwh=12 + n) for n in range(12)],
    )


def unlimited():
    return small().replacing(
        lines=tuple(
            one.model_copy(update={"rating_kva": None, "r_ohm": 0.0}) for one in small().lines
        )
    )


RUNS: dict[str, Callable[[Path], list[object]]] = {
    "default": lambda _: [],
    "default-ac": lambda _: ["--network", "ac"],
    "price-spike": lambda _: [PRESETS / "price-spike"],
    "fcfs": lambda _: ["--policy", "fcfs"],
    "uncoordinated": lambda _: ["--policy", "uncoordinated"],
    "breaking": lambda place: [folder_of(small(), place, BREAKING)],
    "drivers": lambda place: [folder_of(small(), place, DRIVERS)],
    "drivers-ac": lambda place: [folder_of(small(), place, DRIVERS), "--network", "ac"],
    "explained": lambda place: [folder_of(small(), place), "--explain"],
    "unlimited": lambda place: [folder_of(unlimited(), place)],
    "outside": lambda place: [folder_of(outside(), place)],
    "outside-ac": lambda place: [folder_of(outside(), place), "--network", "ac"],
}
LOST = "lost-solver"


def run_of(name: str, place: Path) -> Path:
    """The folder of a run by name, made at a place."""
    if name == LOST:
        write(place / "run", with_a_lost_solver())
    else:
        arguments = [str(one) for one in RUNS[name](place / "scenario")]
        assert main(["run", *arguments, "--out", str(place / "run")]) in (0, 3)
    return place / "run"
