"""Many AC power flows at once, by power-grid-model."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from power_grid_model import (
    ComponentType,
    DatasetType,
    LoadGenType,
    PowerGridModel,
    initialize_array,
)

from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.radial import RadialFeeder
from evdash.grid.sides import Power, away_from_source

ERROR_TOLERANCE = 1e-10
MAX_ITERATIONS = 30
STIFF_SOURCE_VA = 1e16
"""Short-circuit power that leaves no drop worth a nanovolt inside the source."""
VA_PER_KVA = 1000.0


@dataclass(frozen=True, slots=True)
class Flows:
    """AC solutions, NaN where there is none: voltage_pu (flows, nodes).

    `line_power` (flows, lines, 2), kW + j kvar, is what flows away from the source at the end
    nearer to it and at the other; `losses_kw` (flows,) are those of all lines.
    """

    voltage_pu: Floats
    line_power: Power
    losses_kw: Floats

    @property
    def solved(self) -> np.ndarray:
        """Which flows have a solution, (flows,)."""
        return np.asarray(np.isfinite(self.voltage_pu).all(axis=1))


class AcBatch:
    """A feeder of constant-power loads, ready for many flows."""

    def __init__(self, scenario: Scenario, feeder: RadialFeeder) -> None:
        self.feeder = feeder
        self.n_nodes, self.n_lines = len(feeder.nodes), len(feeder.lines)
        ids = {name: i for i, name in enumerate((scenario.feeder.source_node, *feeder.nodes))}
        node = initialize_array(DatasetType.input, ComponentType.node, len(ids))
        node["id"] = np.arange(len(ids))
        node["u_rated"] = scenario.feeder.base_kv * 1000
        line = initialize_array(DatasetType.input, ComponentType.line, self.n_lines)
        line["id"] = len(ids) + np.arange(self.n_lines)
        line["from_node"] = [ids[row.from_node] for row in scenario.lines]
        line["to_node"] = [ids[row.to_node] for row in scenario.lines]
        line["from_status"], line["to_status"] = 1, 1
        line["r1"] = [row.r_ohm for row in scenario.lines]
        line["x1"] = [row.x_ohm for row in scenario.lines]
        line["c1"], line["tan1"] = 0.0, 0.0
        load = initialize_array(DatasetType.input, ComponentType.sym_load, self.n_nodes)
        self.load_ids = len(ids) + self.n_lines + np.arange(self.n_nodes)
        load["id"] = self.load_ids
        load["node"] = np.arange(1, len(ids))
        load["status"], load["type"] = 1, LoadGenType.const_power
        load["p_specified"], load["q_specified"] = 0.0, 0.0
        source = initialize_array(DatasetType.input, ComponentType.source, 1)
        source["id"] = len(ids) + self.n_lines + self.n_nodes
        source["node"], source["status"] = 0, 1
        source["u_ref"], source["sk"] = scenario.feeder.source_voltage_pu, STIFF_SOURCE_VA
        self.model = PowerGridModel(
            {
                ComponentType.node: node,
                ComponentType.line: line,
                ComponentType.sym_load: load,
                ComponentType.source: source,
            }
        )

    def solve(self, active_kw: Floats, reactive_kvar: Floats) -> Flows:
        """Solve for net injections (flows, nodes), kW and kvar; no solution gives NaN."""
        count = len(active_kw)
        load = initialize_array(DatasetType.update, ComponentType.sym_load, (count, self.n_nodes))
        load["id"] = self.load_ids
        load["p_specified"] = -active_kw * VA_PER_KVA
        load["q_specified"] = -reactive_kvar * VA_PER_KVA
        result: Any = self.model.calculate_power_flow(
            update_data={ComponentType.sym_load: load},
            error_tolerance=ERROR_TOLERANCE,
            max_iterations=MAX_ITERATIONS,
            continue_on_batch_error=True,
            output_component_types={
                ComponentType.node: ["u_pu"],
                ComponentType.line: ["p_from", "q_from", "p_to", "q_to"],
            },
        )
        voltage_pu = result[ComponentType.node]["u_pu"][:, 1:].copy()
        line = result[ComponentType.line]
        with np.errstate(all="ignore"):  # where a flow failed, numbers are anything
            ends = [(line[f"p_{e}"] + 1j * line[f"q_{e}"]) / VA_PER_KVA for e in ("from", "to")]
            line_power = away_from_source(self.feeder, *ends)
            losses_kw = (line["p_from"] + line["p_to"]).sum(axis=1) / VA_PER_KVA
        failed = self.model.batch_error
        if failed is not None:
            voltage_pu[failed.failed_scenarios] = np.nan
            line_power[failed.failed_scenarios] = np.nan
            losses_kw[failed.failed_scenarios] = np.nan
        return Flows(voltage_pu, line_power, losses_kw)
