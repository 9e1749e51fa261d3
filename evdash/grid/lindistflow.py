"""Linearised DistFlow, the paper's power system model: equations (1) and (3)."""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats
from evdash.domain.scenario import Node, Scenario
from evdash.grid.radial import KW_PER_MW, RadialFeeder
from evdash.grid.sides import Power


@dataclass(frozen=True, slots=True)
class Injections:
    """Net injections without the station, kW and kvar, each (intervals, nodes)."""

    active_kw: Floats
    reactive_kvar: Floats

    @property
    def net_load(self) -> Power:
        """What leaves the feeder at each node, kW + j kvar."""
        return -(self.active_kw + 1j * self.reactive_kvar)


def base_injections(scenario: Scenario, feeder: RadialFeeder) -> Injections:
    """(1) node balance: generation minus load, before any charging.

    A load without kvar takes them from the power factor; load_scale applies to loads only;
    a shunt is a constant injection of reactive power.
    """
    by_name = {node.node: node for node in scenario.nodes}
    nodes = [by_name[name] for name in feeder.nodes]
    load_kw = np.array([node.load_kw or 0.0 for node in nodes])
    load_kvar = np.array([load_kvar_of(node, scenario.feeder.power_factor) for node in nodes])
    generation_kw = np.array([node.generation_kw or 0.0 for node in nodes])
    shunt_kvar = np.array([node.shunt_kvar or 0.0 for node in nodes])
    load = scenario.load_pu * scenario.feeder.load_scale
    return Injections(
        active_kw=np.outer(scenario.generation_pu, generation_kw) - np.outer(load, load_kw),
        reactive_kvar=shunt_kvar - np.outer(load, load_kvar),
    )


def load_kvar_of(node: Node, power_factor: float) -> float:
    """Peak reactive load of a node, kvar: as given, or from the lagging power factor."""
    if node.load_kvar is not None:
        return node.load_kvar
    return (node.load_kw or 0.0) * float(np.sqrt(1 - power_factor**2)) / power_factor


def sensitivity(feeder: RadialFeeder, impedance_pu: Floats, node: int) -> Floats:
    """A column of R or X of (3): twice the impedance of the lines that the ways to each node and
    to `node`, by its index, share, (nodes,). Both matrices are symmetric."""
    return np.asarray(2 * feeder.on_way[:, feeder.on_way[node]] @ impedance_pu[feeder.on_way[node]])


def voltage_sq_pu(scenario: Scenario, feeder: RadialFeeder, injections: Injections) -> Floats:
    """(3) linearised DistFlow: v = v_0·1 + R p + X q, squared voltages, (intervals, nodes).

    R p is what r times the flow in each line adds up to along a node's way, so that R and X,
    dense in the nodes, are never formed.
    """
    base_kva = scenario.feeder.base_mva * KW_PER_MW
    flows = line_flows(feeder, injections)
    drop = 2 * (flows.active_kw * feeder.r_pu + flows.reactive_kvar * feeder.x_pu) / base_kva
    fallen = drop @ feeder.on_way.astype(float).T
    return np.asarray(scenario.feeder.source_voltage_pu**2 - fallen)


def voltage_pu(scenario: Scenario, feeder: RadialFeeder, station_kw: Floats) -> Floats:
    """Voltage magnitudes with the station drawing `station_kw` (intervals,), (intervals, nodes)."""
    injections = with_station(scenario, feeder, base_injections(scenario, feeder), station_kw)
    return np.sqrt(np.maximum(0.0, voltage_sq_pu(scenario, feeder, injections)))


def with_station(
    scenario: Scenario, feeder: RadialFeeder, base: Injections, station_kw: Floats
) -> Injections:
    """(1), (8): the station's power taken out at its node."""
    active_kw = base.active_kw.copy()
    active_kw[:, feeder.node_index(scenario.station.node)] -= station_kw
    return Injections(active_kw, base.reactive_kvar)


def line_flows(feeder: RadialFeeder, injections: Injections) -> Injections:
    """What flows through each line away from the source, lossless: (intervals, lines)."""
    ways = feeder.on_way.astype(float)
    return Injections(-injections.active_kw @ ways, -injections.reactive_kvar @ ways)
