"""Lossless DistFlow by walking the feeder, and which limits the station worsens.

Instead of R and X matrices this walks from the leaves to the source for flows and back for
voltages, as in v_child = v_parent − 2 (r P + x Q), so that it can referee them. The walk is
linear in the station's power: taken once without it and once with UNIT_KW, it is known for any.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario

UNIT_KW = 1000.0
TOLERANCE_KVA = 1e-6
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
    """A scenario's feeder, walked without the station and with it, held against its limits."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.order, self.parent, self.line_of = self._walk()
        none = np.zeros(scenario.intervals)
        self.base = self.sweep(none)
        self.loaded = _Loaded.between(self.base, self.sweep(none + UNIT_KW), self._rated())
        self._base_depths = self._own_depths()

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

    def _rated(self) -> "list[_Rated]":
        """Every rating: of a node's net injection, of what flows through a line."""
        source = self.scenario.feeder.source_node
        nodes = [
            _Rated(node.node, Element("node", node.node), node.rating_kva, injection=True)
            for node in self.scenario.nodes
            if node.rating_kva is not None and node.node != source
        ]
        lines = ((node, self.scenario.lines[row]) for node, row in self.line_of.items())
        return nodes + [
            _Rated(node, line.element, line.rating_kva, injection=False)
            for node, line in lines
            if line.rating_kva is not None
        ]

    def breaches(self, station_kw: Floats) -> list[Breach]:
        """Every limit exceeded in any interval, by the station or by the feeder itself."""
        limits, depths = self.loaded.limits, self._depths(station_kw)
        in_pu = np.array([unit == "pu" for _, unit in limits])
        tolerance = np.where(in_pu, TOLERANCE_PU, TOLERANCE_KVA)
        return [
            Breach(
                interval=int(t),
                element=limits[i][0],
                depth=float(depths[i, t]),
                base_depth=float(self._base_depths[i, t]),
                unit=limits[i][1],
                tolerance=float(tolerance[i]),
            )
            for i, t in np.argwhere(depths > tolerance[:, None])
        ]

    def _depths(self, station_kw: Floats) -> Floats:
        """How far each side of each limit is exceeded, 0 where kept, (limits, intervals)."""
        feeder, loaded = self.scenario.feeder, self.loaded
        squared = loaded.voltage_sq_pu + loaded.voltage_sq_per_kw * station_kw
        # the root with its sign, so that charging still worsens a voltage past collapse
        voltage = np.sign(squared) * np.sqrt(np.abs(squared))
        active_kw = loaded.active_kw + loaded.active_per_kw * station_kw
        over_kva = np.hypot(active_kw, loaded.reactive_kvar) - loaded.rating_kva
        sides = (
            feeder.voltage_min_pu - voltage,
            voltage - feeder.voltage_max_pu,
            np.where(active_kw >= 0, over_kva, 0.0),
            np.where(active_kw < 0, over_kva, 0.0),
        )
        return np.asarray(np.maximum(0.0, np.concatenate(sides)))

    def _own_depths(self) -> Floats:
        """The same without the station. Reactive power alone counts on both sides of a rating: it
        fills the other already when active power turns."""
        depths, loaded = self._depths(np.zeros(self.scenario.intervals)), self.loaded
        by_reactive = np.abs(loaded.reactive_kvar) - loaded.rating_kva
        voltages = np.zeros((len(depths) - 2 * len(by_reactive), self.scenario.intervals))
        return np.asarray(np.maximum(depths, np.concatenate([voltages, by_reactive, by_reactive])))


@dataclass(frozen=True, slots=True)
class _Rated:
    """A rating, kVA, on what flows into `node`, or on its net injection alone."""

    node: str
    element: Element
    rating_kva: float
    injection: bool


@dataclass(frozen=True, slots=True)
class _Loaded:
    """Everything limited, without the station and per kW of it.

    `limits`: element and unit, lower and upper voltages first, then both sides of ratings.
    Shapes: voltages (nodes, intervals) and (nodes, 1); active_kw and reactive_kvar
    (ratings, intervals); active_per_kw and rating_kva (ratings, 1).
    """

    limits: list[tuple[Element, str]]
    voltage_sq_pu: Floats
    voltage_sq_per_kw: Floats
    active_kw: Floats
    active_per_kw: Floats
    reactive_kvar: Floats
    rating_kva: Floats

    @classmethod
    def between(cls, base: Sweep, unit: Sweep, rated: list[_Rated]) -> "_Loaded":
        """From the walk without the station and the one with UNIT_KW of it."""
        nodes = list(base.voltage_sq_pu)[1:]  # the source's is held
        shape = (-1, len(base.voltage_sq_pu[nodes[0]]))

        def active(sweep: Sweep) -> Floats:
            flows = [(sweep.net_kw if r.injection else sweep.flow_kw)[r.node] for r in rated]
            return np.reshape(flows, shape)

        def squared(sweep: Sweep) -> Floats:
            return np.array([sweep.voltage_sq_pu[node] for node in nodes])

        reactive = [(base.net_kvar if r.injection else base.flow_kvar)[r.node] for r in rated]
        return cls(
            limits=[(Element("voltage_min", node), "pu") for node in nodes]
            + [(Element("voltage_max", node), "pu") for node in nodes]
            + [(r.element, "kVA") for r in rated]
            + [(r.element.export_side, "kVA") for r in rated],
            voltage_sq_pu=squared(base),
            voltage_sq_per_kw=(squared(unit) - squared(base))[:, :1] / UNIT_KW,
            active_kw=active(base),
            active_per_kw=(active(unit) - active(base))[:, :1] / UNIT_KW,
            reactive_kvar=np.reshape(reactive, shape),
            rating_kva=np.reshape([r.rating_kva for r in rated], (-1, 1)),
        )
