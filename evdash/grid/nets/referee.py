"""The original network's own AC power flow, by pandapower, against the scenario's."""

from dataclasses import dataclass
from datetime import datetime
from typing import Any

import numpy as np

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.scenario import Feeder, PriceOption, ProfileRow, Scenario, Station
from evdash.grid.acflow import ac_flow
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.records import RECORDS, Net
from evdash.grid.radial import KW_PER_MW

SOME_DAY = datetime(2020, 1, 1)


@dataclass(frozen=True, slots=True)
class AcDifference:
    """How the scenario's AC power flow at full load differs from the original network's.

    `worst_pu` compares voltages per unit of each bus's own nominal voltage, at `worst_bus`;
    `supply_kw` is how much more the scenario draws from its source, `original_supply_kw` what the
    original draws; `lowest_pu` the original's lowest voltage.
    """

    worst_pu: float
    worst_bus: str
    lowest_pu: float
    supply_kw: float
    original_supply_kw: float

    @property
    def text(self) -> str:
        return (
            f"AC power flow at full load against the original network's: voltages differ by at "
            f"most {self.worst_pu:.2g} pu (at {self.worst_bus}; the original's lowest is "
            f"{self.lowest_pu:.4f} pu), the power drawn from the source by {self.supply_kw:+,.2g} "
            f"of {self.original_supply_kw:,.1f} kW."
        )


def ac_difference(net: Net, feeder: ConvertedFeeder) -> AcDifference | None:
    """The difference with all loads and generation at their peak and no station; None where
    either power flow has no solution."""
    original = _solved(net)
    flow = ac_flow(full_load(feeder), np.zeros(1))
    if original is None or flow.diverged:
        return None
    volts = {feeder.source_node: feeder.source_voltage_pu}
    volts |= dict(zip(flow.nodes, flow.voltage_pu[0], strict=True))
    errors: dict[str, float] = {}
    lowest = np.inf
    for bus, node in feeder.node_of_bus.items():
        true = float(original.res_bus.vm_pu.at[bus])
        errors[node] = max(
            errors.get(node, 0.0), abs(float(volts[node]) * feeder.scale_of_node[node] - true)
        )
        lowest = min(lowest, true)
    worst = max(errors, key=lambda node: errors[node])
    others = [node for node in feeder.nodes if node.node != feeder.source_node]
    ours_kw = float(flow.losses_kw[0]) + sum(
        (node.load_kw or 0.0) - (node.generation_kw or 0.0) for node in others
    )
    return AcDifference(
        worst_pu=errors[worst],
        worst_bus=worst,
        lowest_pu=lowest,
        supply_kw=ours_kw - _beyond_source_kw(original, feeder),
        original_supply_kw=_beyond_source_kw(original, feeder),
    )


def full_load(feeder: ConvertedFeeder) -> Scenario:
    """One interval of the feeder alone at full load and generation; its station stands idle."""
    return Scenario(
        format=1,
        name="full load",
        start=SOME_DAY,
        interval_minutes=60,
        intervals=1,
        feeder=Feeder(
            source_node=feeder.source_node,
            source_voltage_pu=feeder.source_voltage_pu,
            voltage_min_pu=0.9,
            voltage_max_pu=1.1,
            base_mva=feeder.base_mva,
            base_kv=feeder.base_kv,
            load_scale=1.0,
            power_factor=1.0,
        ),
        station=Station(
            node=feeder.heaviest_node(), chargers=0, min_kw=0.0, max_kw=1.0, efficiency=1.0
        ),
        option=(PriceOption(name="none", price_per_kwh=0.0, average_kw=1.0),),
        arrivals=RecordedArrivals(),
        nodes=feeder.nodes,
        lines=feeder.lines,
        profile=(ProfileRow(interval=0, price_per_kwh=0.0, load_pu=1.0, generation_pu=1.0),),
    )


def _beyond_source_kw(original: Any, feeder: ConvertedFeeder) -> float:
    """What the original draws from the chosen supply beyond what is drawn at the source itself,
    which a scenario does not compute."""
    at_source = [b for b, node in feeder.node_of_bus.items() if node == feeder.source_node]
    grids = original.ext_grid.index[original.ext_grid.bus.isin(at_source)]
    drawn = float(original.res_ext_grid.p_mw[grids].sum()) * KW_PER_MW
    own = next(node for node in feeder.nodes if node.node == feeder.source_node)
    return drawn - (own.load_kw or 0.0) + (own.generation_kw or 0.0)


def _solved(net: Net) -> Any:
    """The network in pandapower, solved; None where it has no solution."""
    import pandapower  # imported here: it takes seconds, and the first page must not wait

    built = as_pandapower(net)
    try:
        pandapower.runpp(built, numba=False, tolerance_mva=1e-8, max_iteration=30)
    except (pandapower.LoadflowNotConverged, ArithmeticError, np.linalg.LinAlgError):
        return None
    return built


def as_pandapower(net: Net) -> Any:
    """A pandapower network built from checked records, with nothing else of the file in it."""
    import pandapower
    import pandas as pd

    built = pandapower.create_empty_network(f_hz=net.f_hz, sn_mva=net.sn_mva)
    for table in RECORDS:
        rows = [element.model_dump() for element in getattr(net, table)]
        if not rows:
            continue
        frame = pd.DataFrame(rows).set_index("index")
        built[table] = _as_table(frame, built[table])
    built.ext_grid["va_degree"], built.ext_grid["slack_weight"] = 0.0, 1.0
    built.shunt["step_dependency_table"] = False
    nominal = built.bus.vn_kv.loc[built.shunt.bus.astype(int)].to_numpy()
    built.shunt["vn_kv"] = built.shunt.vn_kv.where(built.shunt.vn_kv.notna(), nominal)
    return built


def _as_table(frame: Any, empty: Any) -> Any:
    """Records as one of pandapower's tables, whose columns and kinds `empty` has."""
    whole = frame.reindex(columns=empty.columns)
    for column, kind in empty.dtypes.items():
        if kind.kind == "f" or not whole[column].isna().any():  # a blank float is NaN
            whole[column] = whole[column].astype(kind)
    return whole
