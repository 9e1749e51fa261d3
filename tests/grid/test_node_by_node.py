"""The named rows are the paper's feeder, no more and no less: equal optimum of P1.

Random feeders and days; on each, one kind of limit is made to bind, and a third or more of the
vehicles are refused. The base case keeps its limits, where both must agree.
"""

from dataclasses import replace

import numpy as np
import pytest

from evdash.checker.feeder import FeederCheck
from evdash.checker.plans import plan_problems
from evdash.domain.limits import LimitRows
from evdash.grid.reduction import limit_rows
from evdash.horizon.advance import advance, contracts_under, snapshot_of
from evdash.horizon.day import start_day
from evdash.scheduling.effort import Effort
from evdash.scheduling.equations import P1
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import problem_of
from evdash.scheduling.reference import solve_reference
from tests.builders import line, make_scenario, node, vehicle
from tests.grid.node_by_node import p1_node_by_node, walk

CENT = 0.01
KINDS = ("voltage", "node", "line", "chargers", "time")
INTERVALS = 5


def random_feeder(rng, kind):
    """A random tree with loads, shunts and generation; the station anywhere but the source."""
    names = ["s", *"abcdefg"[: rng.integers(1, 8)]]
    # where voltage is to bind, every way begins with the same line: all nodes feel the station
    top = 1 if kind == "voltage" else 0
    nodes = [node("s")] + [
        node(
            name,
            load_kw=rng.uniform(20, 60),
            load_kvar=rng.choice([None, rng.uniform(-10, 30)]),
            shunt_kvar=rng.choice([None, rng.uniform(0, 30)]),
            generation_kw=rng.choice([None, rng.uniform(0, 15)]),
        )
        for name in names[1:]
    ]
    lines = []
    for i, name in enumerate(names[1:], 1):
        parent = names[0 if i == 1 else rng.integers(top, i)]
        lines.append(line(*rng.permutation([parent, name]).tolist(), *rng.uniform(0.02, 0.3, 2)))
    return nodes, [lines[i] for i in rng.permutation(len(lines))], str(rng.choice(names[1:]))


def random_day(seed, kind):
    """A day on a random feeder on which `kind` is what limits charging."""
    rng = np.random.default_rng([seed, KINDS.index(kind)])
    nodes, lines, station = random_feeder(rng, kind)
    price = rng.uniform(-0.05, 0.35, INTERVALS)
    if kind == "time":  # dear at first: whoever must be back soon is not worth it
        price[:4] = rng.uniform(0.42, 0.6, 4)
    scenario = make_scenario(
        nodes=nodes,
        lines=lines,
        station={"node": station, "chargers": 2 if kind == "chargers" else 9},
        feeder={"voltage_min_pu": 0.8, "voltage_max_pu": 1.2},
        price=price.tolist(),
        load=rng.uniform(0.99, 1, INTERVALS).tolist(),
        generation=rng.uniform(0.95, 1, INTERVALS).tolist(),
        vehicles=[random_vehicle(rng, n) for n in range(9)],
    )
    return tightened(scenario, kind, room_kw=rng.uniform(8, 14))


def random_vehicle(rng, number):
    return vehicle(
        f"{number}",
        hour=float(rng.choice([0, 0, 0, 1])),
        need_kwh=rng.uniform(4, 25),
        battery_kwh=60,
        option=str(rng.choice(["C1", "C2"])),
        max_kw=rng.uniform(5, 11),
    )


def tightened(scenario, kind, room_kw):
    """A limit that the base case keeps and that leaves `room_kw` where it is tightest."""
    base, full = (FeederCheck(scenario).sweep(np.full(INTERVALS, kw)) for kw in (0, room_kw))
    station = scenario.station.node
    if kind == "voltage":
        lowest = float(np.sqrt(min(v.min() for v in full.voltage_sq_pu.values())))
        feeder = scenario.feeder.model_copy(update={"voltage_min_pu": lowest})
        return scenario.replacing(feeder=feeder)
    if kind == "node":
        rating = max(np.hypot(s.net_kw[station], s.net_kvar[station]).max() for s in (base, full))
        return scenario.replacing(nodes=_rated(scenario.nodes, "node", station, rating))
    if kind == "line":
        row, _, child, _ = next(step for step in walk(scenario) if station in step[3])
        rating = max(np.hypot(s.flow_kw[child], s.flow_kvar[child]).max() for s in (base, full))
        name = scenario.lines[row].name
        return scenario.replacing(lines=_rated(scenario.lines, "name", name, rating))
    return scenario


def _rated(rows, key, name, rating):
    rated = {"rating_kva": float(rating)}
    return tuple(row.model_copy(update=rated) if getattr(row, key) == name else row for row in rows)


def without(problem, kind):
    """The problem without the kind of limit that is to bind."""
    if kind == "chargers":
        return replace(problem, chargers=problem.n_vehicles)
    if kind == "time":
        return replace(problem, intervals_left=np.full(problem.n_vehicles, problem.n_slots))
    open_ended = LimitRows((), np.empty((0, 1)), np.empty((problem.n_slots, 0)))
    return replace(problem, rows=open_ended)


def snapshots(scenario):
    """The snapshots of a day under the program's own policy."""
    trace = start_day(scenario)
    state, policy = trace.state, p1_policy()
    while state.now < scenario.intervals:
        snapshot = snapshot_of(trace.inputs, state)
        yield snapshot
        plan = policy(snapshot)
        contracts = contracts_under(plan, snapshot.contracts, snapshot.requests)
        assert plan_problems(FeederCheck(scenario), contracts, plan) == []
        state = advance(state, plan, snapshot.requests, snapshot.interval_hours)


def optimum(problem, equations=P1):
    """Value of P1 at its optimum, $, and who is admitted."""
    solution = solve_reference(problem, Effort(), equations)
    return problem.objective(solution.admitted, solution.power_kw), solution.admitted


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("kind", KINDS)
def test_rows_give_the_optimum_of_the_feeder_node_by_node(kind, seed):
    scenario = random_day(seed, kind)
    assert FeederCheck(scenario).breaches(np.zeros(INTERVALS)) == []
    asked, admitted, costs_of_limit = 0, 0, []
    for snapshot in snapshots(scenario):
        problem = problem_of(snapshot)
        if not problem.n_vehicles:
            continue
        reduced, taken = optimum(problem)
        full, _ = optimum(problem, p1_node_by_node(scenario, snapshot.now))
        assert full == pytest.approx(reduced, abs=CENT)
        costs_of_limit.append(reduced - optimum(without(problem, kind))[0])
        asked += len(snapshot.requests)
        admitted += int(taken[problem.n_contracts :].sum())
    assert max(costs_of_limit) > 5 * CENT  # the limit binds
    assert asked - admitted >= asked / 3


def test_rows_bind_at_the_element_that_was_tightened():
    for kind, element in (("voltage", "voltage_min:"), ("node", "node:"), ("line", "line:")):
        for seed in range(6):
            rows = limit_rows(random_day(seed, kind))
            tightest = rows.headroom_kw().argmin()
            assert str(rows.binding()[tightest]).startswith(element)
            assert 7.9 < rows.headroom_kw()[tightest] < 14.1
