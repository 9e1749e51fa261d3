"""The 33-bus feeder of Baran and Wu as a scenario, from pandapower's own copy of it."""

from typing import Any

import pandapower.networks

from evdash.domain.scenario import Scenario
from tests.builders import generator, line, make_scenario, node


def case33(**changes: Any) -> Scenario:
    """Four hours on all 33 buses at their published loads; tie lines open, as in its base case."""
    net = pandapower.networks.case33bw()
    loads = net.load.groupby("bus")[["p_mw", "q_mvar"]].sum() * 1000
    nodes = [node(f"{bus}") for bus in net.bus.index]
    for row in nodes:
        bus = int(row["node"])
        if bus in loads.index:
            row |= {"load_kw": loads.p_mw[bus], "load_kvar": loads.q_mvar[bus]}
    closed = net.line[net.line.in_service]
    lines = [
        line(f"{one.from_bus}", f"{one.to_bus}", one.r_ohm_per_km, one.x_ohm_per_km)
        for one in closed.itertuples()
    ]
    feeder = {
        "source_node": "0",
        "voltage_min_pu": 0.9,
        "base_kv": float(net.bus.vn_kv.iloc[0]),
        "base_mva": 10.0,
    }
    options: dict[str, Any] = {
        "nodes": nodes,
        "lines": lines,
        "feeder": feeder,
        "station": {"node": "17"},
        "load": (0.6, 1.0, 0.8, 0.7),
        "arrivals": generator(vehicles_per_day=30.0),
        "name": "33 buses",
    }
    return make_scenario(**options | changes)
