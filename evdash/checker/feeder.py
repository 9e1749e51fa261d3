"""Lossless DistFlow by walking the feeder, and which limits the station worsens.

Instead of R and X matrices this walks from the leaves to the source for flows and back for
voltages, as in v_child = v_parent − 2 (r P + x Q), so that it can referee them.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario

TOLERANCE_KW = 1e-6
TOLERANCE_PU = 1e-9


@dataclass(frozen=True, slots=True)
class Sweep:
    """Squared voltages by node, flows into each node and net injections, each (intervals,)."""

    voltage_sq_pu: dict[str, Floats]
    flow_kw: dict[str, Floats]
    flow_kvar: dict[str, Floats]
    net_kw: dict[str, Floats]
    net_kvar: dict[str, Floats]


class FeederCheck:
    """A scenario's feeder, walked once without the station and held against its limits."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.order, self.parent, self.line_of = self._walk()
        self.base = self.sweep(np.zeros(scenario.intervals))
        self._base_depths = self._depths(self.base)

    def _walk(self) -> tuple[list[str], dict[str, str], dict[str, int]]:
        neighbours: dict[str, list[tuple[str, int]]] = {n.node: [] for n in self.scenario.nodes}
        for row, line in enumerate(self.scenario.lines):
            neighbours[line.from_node].append((line.to_node, row))
            neighbours[line.to_node].append((line.from_node, row))
        source = self.scenario.feeder.source_node
        order, parent, line_of = [source], {source: source}, {}
        for node in order:
            for other, row in neighbours[node]:
                if other not in parent:
                    parent[other], line_of[other] = node, row
                    order.append(other)
        return order, parent, line_of

    def sweep(self, station_kw: Floats) -> Sweep:
        """Flows and voltages with the station drawing `station_kw` (intervals,)."""
        settings = self.scenario.feeder
        net_kw, net_kvar = self._net_load(station_kw)
        flow_kw, flow_kvar = dict(net_kw), dict(net_kvar)
        for node in reversed(self.order[1:]):
            up = self.parent[node]
            flow_kw[up] = flow_kw[up] + flow_kw[node]
            flow_kvar[up] = flow_kvar[up] + flow_kvar[node]
        per_unit = settings.base_kv**2 * 1000  # ohm·kW to pu of squared voltage
        start = np.full(len(station_kw), settings.source_voltage_pu**2)
        voltage = {settings.source_node: start}
        for node in self.order[1:]:
            line = self.scenario.lines[self.line_of[node]]
            drop = 2 * (line.r_ohm * flow_kw[node] + line.x_ohm * flow_kvar[node]) / per_unit
            voltage[node] = voltage[self.parent[node]] - drop
        return Sweep(voltage, flow_kw, flow_kvar, net_kw, net_kvar)

    def _net_load(self, station_kw: Floats) -> tuple[dict[str, Floats], dict[str, Floats]]:
        settings = self.scenario.feeder
        load, generation = self.scenario.load_pu * settings.load_scale, self.scenario.generation_pu
        ratio = np.tan(np.arccos(settings.power_factor))
        net_kw, net_kvar = {}, {}
        for node in self.scenario.nodes:
            active = node.load_kw or 0.0
            reactive = active * ratio if node.load_kvar is None else node.load_kvar
            net_kw[node.node] = load * active - generation * (node.generation_kw or 0.0)
            net_kvar[node.node] = load * reactive - (node.shunt_kvar or 0.0)
        net_kw[self.scenario.station.node] = net_kw[self.scenario.station.node] + station_kw
        return net_kw, net_kvar

    def breaches(self, station_kw: Floats) -> list[Breach]:
        """Every limit exceeded in any interval, by the station or by the feeder itself."""
        tolerances = {"pu": TOLERANCE_PU, "kW": TOLERANCE_KW}
        # paired by position: names of lines may coincide (a to b-c, a-b to c)
        pairs = zip(self._depths(self.sweep(station_kw)), self._base_depths, strict=True)
        return [
            Breach(
                interval=int(t),
                element=element,
                depth=float(depth[t]),
                base_depth=float(base_depth[t]),
                unit=unit,
                tolerance=tolerances[unit],
            )
            for (element, depth, unit), (_, base_depth, _) in pairs
            for t in np.flatnonzero(depth > tolerances[unit])
        ]

    def _depths(self, sweep: Sweep) -> list[tuple[str, Floats, str]]:
        """How far each side of each limit is exceeded, 0 where kept: (element, depth, unit)."""
        depths: list[tuple[str, Floats, str]] = []
        limits = self.scenario.feeder
        for node in self.scenario.nodes:
            if node.node == limits.source_node:
                continue
            squared = sweep.voltage_sq_pu[node.node]
            # the root with its sign, so that charging still worsens a voltage past collapse
            voltage = np.sign(squared) * np.sqrt(np.abs(squared))
            low, high = limits.voltage_min_pu - voltage, voltage - limits.voltage_max_pu
            depths.append((f"voltage_min:{node.node}", np.maximum(0.0, low), "pu"))
            depths.append((f"voltage_max:{node.node}", np.maximum(0.0, high), "pu"))
            if node.rating_kva is not None:
                flows = sweep.net_kw[node.node], sweep.net_kvar[node.node]
                depths += _sides(f"node:{node.node}", *flows, node.rating_kva)
        for node_name, row in self.line_of.items():
            line = self.scenario.lines[row]
            if line.rating_kva is not None:
                flows = sweep.flow_kw[node_name], sweep.flow_kvar[node_name]
                depths += _sides(f"line:{line.name}", *flows, line.rating_kva)
        return depths


def _sides(
    element: str, active_kw: Floats, reactive_kvar: Floats, rating_kva: float
) -> list[tuple[str, Floats, str]]:
    """Import and export side of a rating, kW beyond what the reactive flow leaves of it."""
    room = np.sqrt(np.maximum(0.0, rating_kva**2 - reactive_kvar**2))
    return [
        (element, np.maximum(0.0, active_kw - room), "kW"),
        (f"{element}:export", np.maximum(0.0, -active_kw - room), "kW"),
    ]
