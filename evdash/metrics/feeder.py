"""The feeder over the horizon: line loading, headroom, limits exceeded, linearised against AC."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evdash.checker.feeder import FeederCheck
from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.limits import STATION, Floats
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Trace
from evdash.grid.lindistflow import base_injections, line_flows, with_station
from evdash.grid.radial import radial_feeder
from evdash.metrics.breaches import in_force_only
from evdash.metrics.outlook import spans_in_force


@dataclass(frozen=True, slots=True)
class Flows:
    """What flows through each line, kVA, linearised and so lossless.

    Shapes: line_kva with the station, base_line_kva without and rating_kva then in force, inf for
    none, (intervals, lines). Lines stand in the order of `lines.csv`.
    """

    line_kva: Floats
    base_line_kva: Floats
    rating_kva: Floats


@dataclass(frozen=True, slots=True)
class Gap:
    """Linearised against AC voltages of one interval, pu: the lowest of each, and where they
    differ most. `difference` is linearised less AC at `node`."""

    interval: int
    lowest_linear: float
    lowest_ac: float
    node: str
    difference: float


def flows(trace: Trace, outlook: Outlook) -> Flows:
    """Loading of every line under the inputs in force in each interval."""
    shape = (outlook.n_intervals, len(trace.scenario.lines))
    loaded, base, rating = np.empty(shape), np.empty(shape), np.empty(shape)
    for inputs, span in spans_in_force(trace):
        scenario, in_force = inputs.scenario, radial_feeder(inputs.scenario)
        without = base_injections(scenario, in_force)
        with_it = with_station(scenario, in_force, without, outlook.station_kw)
        for injections, into in ((without, base), (with_it, loaded)):
            flow = line_flows(in_force, injections)
            into[span] = np.hypot(flow.active_kw, flow.reactive_kvar)[span]
        rating[span] = in_force.line_rating_kva
    return Flows(loaded, base, rating)


def tightest(trace: Trace, interval: int, most: int) -> tuple[tuple[Element, float], ...]:
    """The elements that leave least room for the station in an interval, and how much, kW.

    In AC one alone is known; of the others a row says nothing in that interval.
    """
    inputs = trace.inputs_at(interval)
    room_kw = inputs.rows.capacity_kw()[interval]
    order = np.argsort(inputs.rows.limit_kw[interval] / inputs.rows.coefficient[:, STATION])
    known = [row for row in order[:most] if np.isfinite(room_kw[row])]
    return tuple((inputs.rows.elements[row], float(room_kw[row])) for row in known)


def day_breaches(trace: Trace, station_kw: Floats) -> tuple[Breach, ...]:
    """Limits exceeded in the linearised model with the station drawing this, (intervals,)."""
    return in_force_only(trace, lambda scenario: FeederCheck(scenario).breaches(station_kw))


def gaps(outlook: Outlook, ac_voltage_pu: Mapping[int, Floats]) -> tuple[Gap, ...]:
    """Linearised against AC for every interval that has an AC solution; arrays (nodes,)."""
    found = []
    for t, ac in sorted(ac_voltage_pu.items()):
        if np.isfinite(ac).all():
            difference = outlook.voltage_pu[t] - ac
            i = int(np.abs(difference).argmax())
            found.append(
                Gap(
                    interval=t,
                    lowest_linear=float(outlook.voltage_pu[t].min()),
                    lowest_ac=float(ac.min()),
                    node=outlook.nodes[i],
                    difference=float(difference[i]),
                )
            )
    return tuple(found)
