"""P1 with the feeder written node by node: (1)-(4) and line ratings as the paper has them.

Shares the charging equations with the program but neither R and X nor the reduction: every
node has its own injection and voltage, every line its own flow, all of them variables.
"""

import math

import pulp

from evdash.scheduling.equations import CHARGING, energy_owed, profit


def feeder_node_by_node(scenario, now=0):
    """The equation that stands in for `feeder_limits` at interval `now`."""

    def equation(model):
        for t in model.slots:
            _Interval(model, scenario, now + t, t).write()

    return equation


def p1_node_by_node(scenario, now=0):
    """P1 as a tuple of equations, the feeder in full."""
    return (profit, *CHARGING, energy_owed, feeder_node_by_node(scenario, now))


class _Interval:
    """The feeder in one interval: p_i, v_i and the flow of each line as variables."""

    def __init__(self, model, scenario, interval, slot):
        self.model, self.scenario, self.slot = model, scenario, slot
        row = scenario.profile[interval]
        self.load = row.load_pu * scenario.feeder.load_scale
        self.generation = row.generation_pu or 0.0
        self.source = scenario.feeder.source_node
        self.nodes = {node.node: node for node in scenario.nodes if node.node != self.source}
        self.p = {name: self._variable(f"p_{i}") for i, name in enumerate(self.nodes)}
        self.v = {name: self._variable(f"v_{i}") for i, name in enumerate(self.nodes)}
        self.flow = [self._variable(f"flow_{i}") for i in range(len(scenario.lines))]
        self.v[self.source] = scenario.feeder.source_voltage_pu**2

    def _variable(self, name):
        return pulp.LpVariable(f"{name}_{self.slot}")

    def write(self):
        self.node_balance()
        self.apparent_power()
        self.flows_and_voltages()
        self.voltage_limits()

    def node_balance(self):
        """(1), (8): p = generation - load - station; load counts negative."""
        for name, node in self.nodes.items():
            station = name == self.scenario.station.node
            fixed = self.generation * (node.generation_kw or 0) - self.load * (node.load_kw or 0)
            charging = self.model.station_kw[self.slot] if station else 0
            self.model.lp += self.p[name] == fixed - charging

    def q(self, name):
        """Reactive injection, constant."""
        node = self.nodes[name]
        tan = math.tan(math.acos(self.scenario.feeder.power_factor))
        load = tan * (node.load_kw or 0) if node.load_kvar is None else node.load_kvar
        return (node.shunt_kvar or 0) - self.load * load

    def apparent_power(self):
        """(2) p² + q² ≤ s̄² with q constant: both sides of p at every node."""
        for name, node in self.nodes.items():
            if node.rating_kva is not None:
                self._within(self.p[name], self.q(name), node.rating_kva)

    def _within(self, active, reactive, rating):
        room = math.sqrt(rating**2 - reactive**2)  # a base case beyond it has no place here
        self.model.lp += active <= room
        self.model.lp += active >= -room

    def flows_and_voltages(self):
        """(3) line by line: what leaves a node's children comes in from its parent; and
        v_child = v_parent - 2 (r P + x Q)."""
        per_unit = self.scenario.feeder.base_kv**2 * 1000
        for row, parent, child, below in walk(self.scenario):
            line = self.scenario.lines[row]
            onward = [
                self.flow[other] for other, start, _, _ in walk(self.scenario) if start == child
            ]
            self.model.lp += self.flow[row] == pulp.lpSum(onward) - self.p[child]
            reactive = -sum(self.q(name) for name in below)
            drop = 2 * (line.r_ohm * self.flow[row] + line.x_ohm * reactive) / per_unit
            self.model.lp += self.v[child] == self.v[parent] - drop
            if line.rating_kva is not None:
                self._within(self.flow[row], reactive, line.rating_kva)

    def voltage_limits(self):
        """(4c) at every node."""
        low, high = self.scenario.feeder.voltage_min_pu, self.scenario.feeder.voltage_max_pu
        for name in self.nodes:
            self.model.lp += self.v[name] >= low**2
            self.model.lp += self.v[name] <= high**2


def walk(scenario):
    """(row, parent, child, all nodes from child on) of every line, from the source outwards."""
    found, reached = [], [scenario.feeder.source_node]
    for parent in reached:
        for row, line in enumerate(scenario.lines):
            ends = [line.from_node, line.to_node]
            if parent in ends and (child := ends[1 - ends.index(parent)]) not in reached:
                reached.append(child)
                found.append([row, parent, child, [child]])
    for _, parent, _, below in reversed(found):
        for link in found:
            if link[2] == parent:
                link[3] += below
    return found
