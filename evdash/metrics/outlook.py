"""Reading the whole horizon off a trace: executed up to now, planned from now on."""

import numpy as np

from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs, Trace
from evdash.grid.lindistflow import voltage_pu
from evdash.grid.radial import RadialFeeder, radial_feeder
from evdash.metrics.records import executed_station_kw


def outlook(trace: Trace) -> Outlook:
    """Conditions, station load and linearised voltages of every interval."""
    scenario = trace.scenario
    feeder = radial_feeder(scenario)
    station_kw = np.concatenate([executed_station_kw(trace), trace.state.tail_kw.sum(axis=0)])
    shape = scenario.intervals
    price, load, headroom = np.empty(shape), np.empty(shape), np.empty(shape)
    voltage, base_voltage = np.empty((2, shape, len(feeder.nodes)))
    binding: list[Element | None] = []
    for inputs, span in spans_in_force(trace):
        price[span] = inputs.scenario.price_per_kwh[span]
        load[span] = load_kw(inputs.scenario)[span]
        headroom[span] = inputs.rows.headroom_kw()[span]
        in_force = inputs.scenario, radial_feeder(inputs.scenario)
        voltage[span] = voltage_pu(*in_force, station_kw)[span]
        base_voltage[span] = voltage_pu(*in_force, np.zeros(shape))[span]
        binding += inputs.rows.binding()[span]
    return Outlook(
        now=trace.now,
        times=tuple(scenario.time_of(interval) for interval in range(scenario.intervals + 1)),
        price_per_kwh=price,
        load_kw=load,
        station_kw=station_kw,
        headroom_kw=headroom,
        binding=tuple(binding),
        nodes=feeder.nodes,
        voltage_pu=voltage,
        base_voltage_pu=base_voltage,
        voltage_min_pu=scenario.feeder.voltage_min_pu,
        voltage_max_pu=scenario.feeder.voltage_max_pu,
        station_rating_kw=station_rating_kw(scenario, feeder),
    )


def spans_in_force(trace: Trace) -> list[tuple[Inputs, slice]]:
    """Which inputs were, and from now on will be, in force over which intervals."""
    spans: list[tuple[Inputs, slice]] = []
    for interval in range(trace.scenario.intervals):
        inputs = trace.inputs_at(interval)
        if spans and spans[-1][0] is inputs:
            spans[-1] = (inputs, slice(spans[-1][1].start, interval + 1))
        else:
            spans.append((inputs, slice(interval, interval + 1)))
    return spans


def load_kw(scenario: Scenario) -> Floats:
    """Active load of the whole feeder without the station, kW, shape (intervals,)."""
    peak_kw = sum(node.load_kw or 0.0 for node in scenario.nodes)
    return np.asarray(scenario.load_pu * scenario.feeder.load_scale * peak_kw)


def station_rating_kw(scenario: Scenario, feeder: RadialFeeder) -> float:
    """The rating nearest to the station on its way to the source, else its chargers' power."""
    station = scenario.station
    at_node = next(n.rating_kva for n in scenario.nodes if n.node == station.node)
    if at_node is not None and at_node > 0:
        return at_node
    nearest = feeder.nearest_rated_line(station.node)
    if nearest is not None:
        return max(1.0, float(feeder.line_rating_kva[nearest]))
    return max(1.0, station.chargers * station.max_kw)
