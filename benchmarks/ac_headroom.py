"""Time to find a day's AC headroom: `python -m benchmarks.ac_headroom`.

Random trees of 100 nodes and the bundled days, 24 intervals or more each; beside the time, what
sets the headroom and how far the linearised model lies above it. Times are of the processor.
"""

import time
from collections import Counter

import numpy as np
from rich.console import Console
from rich.table import Table

from benchmarks.cases import bundled_day
from evdash.domain.scenario import Line, Node, Scenario
from evdash.files.bundled import bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.grid.aclimits import ac_limit_rows
from evdash.grid.reduction import limit_rows

NODES = 100
SEEDS = range(5)
TARGET_SECONDS = 0.5
REPEATS = 3
COLUMNS = ("feeder", "nodes", "headroom, s", "AC, kW", "linearised above AC", "tightest")


def random_tree(seed: int, n_nodes: int = NODES) -> Scenario:
    """The bundled day's loads, prices and station on a random tree of `n_nodes`.

    Each node hangs from one of the five before it; a third of the lines carry a rating. The
    station is in the middle of the tree, so that voltage, lines or neither come to bind.
    """
    rng = np.random.default_rng(seed)
    day = bundled_day(seed)
    names = ["source", *(f"n{i}" for i in range(1, n_nodes))]
    load_kw = rng.uniform(5, 45, n_nodes)
    nodes = [Node(node="source")]
    nodes += [Node(node=name, load_kw=float(kw)) for name, kw in zip(names, load_kw, strict=True)][
        1:
    ]
    lines = [
        Line(
            from_node=names[int(rng.integers(max(0, i - 5), i))],
            to_node=names[i],
            r_ohm=float(rng.uniform(0.005, 0.03)),
            x_ohm=float(rng.uniform(0.005, 0.04)),
            rating_kva=float(rng.uniform(1.1, 1.6) * load_kw.sum())
            if rng.random() < 0.33
            else None,
        )
        for i in range(1, n_nodes)
    ]
    feeder = day.feeder.model_copy(update={"source_node": "source", "source_voltage_pu": 1.04})
    station = day.station.model_copy(update={"node": names[n_nodes // 2]})
    return day.replacing(nodes=tuple(nodes), lines=tuple(lines), feeder=feeder, station=station)


def seconds_of(scenario: Scenario) -> float:
    """Processor time of a day's AC headroom, s: the best of three."""
    taken = []
    for _ in range(REPEATS):
        began = time.process_time()
        ac_limit_rows(scenario)
        taken.append(time.process_time() - began)
    return min(taken)


def row_of(name: str, scenario: Scenario) -> list[str]:
    """One line of the table."""
    rows = ac_limit_rows(scenario)
    ac_kw, linear_kw = rows.headroom_kw(), limit_rows(scenario).headroom_kw()
    above = linear_kw - ac_kw
    tightest = Counter(rows.binding()).most_common(2)
    return [
        name,
        str(len(scenario.nodes)),
        f"{seconds_of(scenario):.2f}",
        f"{ac_kw.min():.0f} to {ac_kw.max():.0f}",
        f"{above.min():.0f} to {above.max():.0f} kW",
        ", ".join(f"{element} ({count})" for element, count in tightest),
    ]


def main() -> None:
    """Every random tree, then every bundled day."""
    table = Table(*COLUMNS, title=f"A day's AC headroom (target {TARGET_SECONDS} s at 100 nodes)")
    for seed in SEEDS:
        table.add_row(*row_of(f"random tree {seed}", random_tree(seed)))
    for folder in bundled_scenarios():
        table.add_row(*row_of(folder.name, read_scenario(folder, ())))
    Console(width=120).print(table)


if __name__ == "__main__":
    main()
