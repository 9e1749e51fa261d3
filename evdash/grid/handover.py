"""The feeder with what it carried, as a pandapower network for others to go on with."""

from typing import Any

import numpy as np
import pandas as pd

from evdash.domain.limits import Floats
from evdash.domain.scenario import Scenario
from evdash.grid.acflow import build_feeder
from evdash.grid.lindistflow import load_kvar_of
from evdash.grid.radial import KW_PER_MW

LEAST_X_OHM = 1e-7
"""A line's reactance where it has none: too little to change a voltage by 1e-9 pu."""
STATION = "charging station"
CARRIED = (("load", "p_mw"), ("load", "q_mvar"), ("sgen", "p_mw"))
"""What changes from interval to interval, by pandapower's tables and columns."""


def handover_json(scenario: Scenario, station_kw: Floats, interval: int) -> str:
    """The feeder as pandapower JSON, loaded as in `interval`, the other intervals within.

    `station_kw` (intervals,) is what the station draws. `pandapower.from_json` and `runpp` give
    the voltages of that interval, `pandapower.timeseries.run_timeseries` over
    `range(intervals)` those of the day: the network carries its loads and generation as
    controllers with their values. Loads, generation, capacitors and the station draw constant
    power; ratings are currents at nominal voltage, NaN for none.
    """
    import pandapower

    net = build_feeder(scenario)
    net.name = scenario.name
    _place_buses(net, scenario)
    _set_limits(net, scenario)
    # runpp begins with a DC flow, which divides by reactances
    net.line["x_ohm_per_km"] = net.line["x_ohm_per_km"].clip(lower=LEAST_X_OHM)
    day = _add_elements(net, scenario, station_kw)
    for place, values in day.items():
        table, column = place
        net[table].loc[values.columns, column] = values.loc[interval].to_numpy()
        _carry(net, table, column, values)
    text: str = pandapower.to_json(net)
    return text


def _place_buses(net: Any, scenario: Scenario) -> None:
    """Drawing positions as pandapower keeps them, where every node has one."""
    places = {node.node: (node.x, node.y) for node in scenario.nodes}
    if all(x is not None and y is not None for x, y in places.values()):
        net.bus["geo"] = [
            f'{{"type": "Point", "coordinates": [{places[name][0]}, {places[name][1]}]}}'
            for name in net.bus["name"]
        ]


def _set_limits(net: Any, scenario: Scenario) -> None:
    """Ratings of lines, voltage limits of all buses but the source, which holds its own, and, in a
    column that pandapower does not know, the nodes' ratings."""
    kva_per_ka = np.sqrt(3) * scenario.feeder.base_kv * KW_PER_MW
    net.line["max_i_ka"] = [
        np.nan if line.rating_kva is None else line.rating_kva / kva_per_ka
        for line in scenario.lines
    ]
    net.line["max_loading_percent"] = 100.0
    feeder = scenario.feeder
    beside = net.bus["name"] != feeder.source_node
    net.bus.loc[beside, ["min_vm_pu", "max_vm_pu"]] = feeder.voltage_min_pu, feeder.voltage_max_pu
    ratings = {node.node: node.rating_kva for node in scenario.nodes}
    if any(rating is not None for rating in ratings.values()):
        net.bus["rating_kva"] = [
            np.nan if (rating := ratings.get(name)) is None else rating for name in net.bus["name"]
        ]


def _add_elements(
    net: Any, scenario: Scenario, station_kw: Floats
) -> dict[tuple[str, str], pd.DataFrame]:
    """Loads, generation, capacitors and the station; the values each takes over the day.

    By table and column a frame (intervals, elements) in MW or Mvar.
    """
    import pandapower

    feeder, source = scenario.feeder, scenario.feeder.source_node
    bus = dict(zip(net.bus["name"], net.bus.index, strict=True))
    load_pu = scenario.load_pu * feeder.load_scale
    day: dict[tuple[str, str], dict[int, Floats]] = {place: {} for place in CARRIED}
    for node in scenario.nodes:
        if node.node == source:
            continue
        load_kvar = load_kvar_of(node, feeder.power_factor)
        if node.load_kw or load_kvar:
            i = int(pandapower.create_load(net, bus[node.node], 0.0, name=f"load {node.node}"))
            day["load", "p_mw"][i] = load_pu * (node.load_kw or 0.0) / KW_PER_MW
            day["load", "q_mvar"][i] = load_pu * load_kvar / KW_PER_MW
        if node.generation_kw:
            name = f"generation {node.node}"
            i = int(pandapower.create_sgen(net, bus[node.node], 0.0, name=name))
            day["sgen", "p_mw"][i] = scenario.generation_pu * node.generation_kw / KW_PER_MW
        if node.shunt_kvar:
            name, q_mvar = f"capacitor {node.node}", node.shunt_kvar / KW_PER_MW
            pandapower.create_sgen(net, bus[node.node], 0.0, q_mvar=q_mvar, name=name)
    station = pandapower.create_load(net, bus[scenario.station.node], 0.0, name=STATION)
    day["load", "p_mw"][int(station)] = np.asarray(station_kw) / KW_PER_MW
    return {place: pd.DataFrame(values) for place, values in day.items() if values}


def _carry(net: Any, table: str, column: str, values: pd.DataFrame) -> None:
    """The day's values of one column as a controller of the network."""
    from pandapower.control import ConstControl
    from pandapower.timeseries import DFData

    ConstControl(
        net,
        element=table,
        variable=column,
        element_index=list(values.columns),
        profile_name=list(values.columns),
        data_source=DFData(values),
    )
