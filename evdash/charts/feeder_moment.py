"""The feeder in one interval: what its drawing shows."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evdash.charts.feeder_layout import Layout
from evdash.charts.voltage_map import VOLTAGE_TOLERANCE_PU, MapWay
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Scenario
from evdash.metrics.feeder import Flows


@dataclass(frozen=True, slots=True)
class Moment:
    """What is drawn: one interval, one way to look at it, AC voltages (nodes,) where known."""

    scenario: Scenario
    outlook: Outlook
    flows: Flows
    layout: Layout
    interval: int
    way: MapWay = "with"
    ac_pu: Floats | None = None

    @property
    def voltage_pu(self) -> dict[str, float]:
        """Voltage by node, the source's too; in the way `difference` the drop by charging."""
        outlook, t = self.outlook, self.interval
        base, loaded = outlook.base_voltage_pu[t], outlook.voltage_pu[t]
        shown = {"with": loaded, "without": base, "difference": base - loaded}[self.way]
        source = 0.0 if self.way == "difference" else self.scenario.feeder.source_voltage_pu
        values = (float(value) for value in shown)
        return {
            self.scenario.feeder.source_node: source,
            **dict(zip(outlook.nodes, values, strict=True)),
        }

    @property
    def line_kva(self) -> Floats:
        """Flow by line; in the way `difference` what charging adds."""
        base, loaded = self.flows.base_line_kva, self.flows.line_kva
        shown = {"with": loaded, "without": base, "difference": loaded - base}[self.way]
        return np.asarray(shown[self.interval])

    @property
    def loading(self) -> Floats:
        """Share of each line's rating, NaN where it has none."""
        rating = self.flows.rating_kva
        with np.errstate(divide="ignore", invalid="ignore"):
            share = self.line_kva / rating
        return np.where(np.isinf(rating), np.nan, np.where(rating > 0, share, np.inf))


def nodes_outside(moment: Moment, voltage: Mapping[str, float]) -> list[str]:
    """The nodes whose voltage is beyond a limit."""
    low = moment.outlook.voltage_min_pu - VOLTAGE_TOLERANCE_PU
    high = moment.outlook.voltage_max_pu + VOLTAGE_TOLERANCE_PU
    return [n for n, pu in voltage.items() if not low <= pu <= high and np.isfinite(pu)]


def feeder_table(moment: Moment) -> list[dict[str, object]]:
    """The nodes of the drawing as rows of a table, the lowest voltage first."""
    outlook, t = moment.outlook, moment.interval
    rows: list[dict[str, object]] = [
        {
            "Node": node,
            "With charging, pu": round(float(outlook.voltage_pu[t, i]), 5),
            "Without, pu": round(float(outlook.base_voltage_pu[t, i]), 5),
            "Drop by charging, pu": round(
                float(outlook.base_voltage_pu[t, i] - outlook.voltage_pu[t, i]), 5
            ),
            "By AC, pu": None if moment.ac_pu is None else _or_none(moment.ac_pu[i]),
        }
        for i, node in enumerate(outlook.nodes)
    ]
    return sorted(rows, key=lambda row: float(str(row["With charging, pu"])))


def lines_table(moment: Moment) -> list[dict[str, object]]:
    """The lines of the drawing as rows of a table, the most loaded first."""
    flows, t = moment.flows, moment.interval
    rows: list[dict[str, object]] = [
        {
            "Line": f"{line.from_node}–{line.to_node}",
            "With charging, kVA": round(float(flows.line_kva[t, i]), 1),
            "Without, kVA": round(float(flows.base_line_kva[t, i]), 1),
            "Rating, kVA": line.rating_kva,
            "Loading, %": _percent(flows.line_kva[t, i], line.rating_kva),
        }
        for i, line in enumerate(moment.scenario.lines)
    ]
    return sorted(rows, key=lambda row: -float(str(row["Loading, %"] or 0.0)))


def feeder_alt(moment: Moment) -> str:
    """The drawing in one sentence."""
    outlook, t = moment.outlook, moment.interval
    i = int(outlook.voltage_pu[t].argmin())
    return (
        f"One-line drawing of the feeder with {len(outlook.nodes) + 1} nodes at "
        f"{outlook.times[t]:%H:%M}: lowest voltage {outlook.voltage_pu[t, i]:.4f} pu at node "
        f"{outlook.nodes[i]}; lines by loading, the charging station at node "
        f"{moment.scenario.station.node}."
    )


def _percent(kva: float, rating_kva: float | None) -> float | None:
    return round(100 * float(kva) / rating_kva, 1) if rating_kva else None


def _or_none(value: float) -> float | None:
    return round(float(value), 5) if np.isfinite(value) else None
