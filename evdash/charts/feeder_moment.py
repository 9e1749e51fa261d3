"""The feeder in one interval: what its drawing shows."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from evdash.charts.feeder_layout import Layout
from evdash.charts.voltage_map import MapWay
from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.limits import Floats
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Line, Scenario
from evdash.domain.trace import Network
from evdash.domain.words import element_name
from evdash.metrics.ac import AcPoint
from evdash.metrics.feeder import Flows
from evdash.metrics.verdict import FULL_AC, LINEARISED

FULL_PERCENT = 100
MODELS: Mapping[Network, str] = {LINEARISED: "linearised", FULL_AC: "AC"}


@dataclass(frozen=True, slots=True)
class Moment:
    """What is drawn: one interval, one way to look at it, and what the models say of its limits.

    `linear` are the limits exceeded in it in the linearised model, `without` those exceeded
    without charging; `ac` what AC power flow found, None where it has not been asked.
    """

    scenario: Scenario
    outlook: Outlook
    flows: Flows
    layout: Layout
    interval: int
    way: MapWay = "with"
    linear: tuple[Breach, ...] = ()
    without: tuple[Breach, ...] = ()
    ac: AcPoint | None = None

    @property
    def seen_in_ac(self) -> AcPoint | None:
        """What AC power flow found, if that is what is shown: it knows the day with charging."""
        return self.ac if self.way == "with" else None

    @property
    def exceeded(self) -> dict[Network, frozenset[Element]]:
        """The elements beyond a limit in what is shown, by model, whichever side is exceeded."""
        shown = {"with": self.linear, "without": self.without, "difference": ()}[self.way]
        in_ac = self.seen_in_ac.breaches if self.seen_in_ac else ()
        return {
            network: frozenset(breach.element.import_side for breach in breaches)
            for network, breaches in ((LINEARISED, shown), (FULL_AC, in_ac))
        }

    def models_over(self, line: Line) -> list[Network]:
        """The models in which a line is over its rating."""
        return [network for network, found in self.exceeded.items() if line.element in found]

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
    def rating_kva(self) -> Floats:
        """Rating by line, inf for none."""
        return np.asarray(self.flows.rating_kva[self.interval])

    @property
    def loading(self) -> Floats:
        """Share of each line's rating, NaN where it has none."""
        return self._share(self.line_kva)

    @property
    def ac_loading(self) -> Floats:
        """The same by AC power flow, NaN also where that is not known or shown."""
        unknown = np.full(len(self.scenario.lines), np.nan)
        return self._share(unknown if self.seen_in_ac is None else self.seen_in_ac.line_kva)

    def _share(self, kva: Floats) -> Floats:
        rating = self.rating_kva
        with np.errstate(divide="ignore", invalid="ignore"):
            share = kva / rating
        share = np.where(rating > 0, share, np.inf)
        return np.where(np.isinf(rating) | np.isnan(kva), np.nan, share)


def nodes_outside(moment: Moment, network: Network) -> list[str]:
    """The nodes whose voltage or injection is beyond a limit in a model."""
    found = {one.node for one in moment.exceeded[network] if one.kind != "line"}
    return [node.node for node in moment.scenario.nodes if node.node in found]


def percent_told(share: float, *, is_over: bool) -> str:
    """A line's loading in %, never rounded to the other side of its rating."""
    if np.isinf(share):
        return "rated 0 kVA"
    percent = 100 * share
    if is_over and round(percent) <= FULL_PERCENT:
        return f"{percent:.2f} %" if round(percent, 2) > FULL_PERCENT else "just over 100 %"
    return f"{percent:.0f} %"


def loading_told(moment: Moment, row: int) -> str:
    """A line's loading in %; by AC power flow, too, where that finds it over its rating."""
    over = moment.models_over(moment.scenario.lines[row])
    told = percent_told(float(moment.loading[row]), is_over=LINEARISED in over)
    in_ac = float(moment.ac_loading[row])
    if FULL_AC not in over or np.isnan(in_ac):
        return told
    return f"{told}, AC {percent_told(in_ac, is_over=True)}"


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
            "By AC, pu": None if moment.ac is None else _or_none(moment.ac.voltage_pu[i]),
        }
        for i, node in enumerate(outlook.nodes)
    ]
    return sorted(rows, key=lambda row: float(str(row["With charging, pu"])))


def lines_table(moment: Moment) -> list[dict[str, object]]:
    """The lines of the drawing as rows of a table, the most loaded first."""
    flows, t = moment.flows, moment.interval
    unknown = np.full(len(moment.scenario.lines), np.nan)
    ac_kva = unknown if moment.ac is None else moment.ac.line_kva
    rows: list[dict[str, object]] = [
        {
            "Line": f"{line.from_node}–{line.to_node}",
            "With charging, kVA": round(float(flows.line_kva[t, i]), 1),
            "Without, kVA": round(float(flows.base_line_kva[t, i]), 1),
            "Rating, kVA": _or_none(moment.rating_kva[i]),
            "Loading, %": _percent(flows.line_kva[t, i], moment.rating_kva[i]),
            "By AC, kVA": _or_none(ac_kva[i], 1),
            "Loading by AC, %": _percent(ac_kva[i], moment.rating_kva[i]),
            "Over its rating": ", ".join(MODELS[n] for n in moment.models_over(line)),
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
        f"{moment.scenario.station.node}.{_exceeded_told(moment)}"
    )


def _exceeded_told(moment: Moment) -> str:
    return "".join(
        f" Outside limits, {MODELS[network]}: "
        f"{', '.join(element_name(one) for one in sorted(found, key=str))}."
        for network, found in moment.exceeded.items()
        if found
    )


def _percent(kva: float, rating_kva: float) -> float | None:
    return _or_none(100 * kva / rating_kva, 1) if 0 < rating_kva < np.inf else None


def _or_none(value: float, digits: int = 5) -> float | None:
    return round(float(value), digits) if np.isfinite(value) else None
