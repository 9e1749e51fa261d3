"""What is told of limits, everywhere, against pandapower and the walk of the checker.

Every bundled day in both network models. The referee here takes voltages and flows, holds them
against the scenario's numbers, and counts by itself; headline, drawing, race, report and command
line must claim what it found, and nothing else.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from html import unescape

import numpy as np
import pytest

from evdash.charts.feeder import feeder_figure
from evdash.charts.feeder_layout import layout_of
from evdash.charts.feeder_moment import Moment, feeder_alt, loading_told
from evdash.charts.race import profit_alt, profit_figure
from evdash.checker.feeder import FeederCheck
from evdash.cli.report import print_report
from evdash.domain.breach import Breach
from evdash.domain.elements import Element
from evdash.domain.trace import Network, Trace
from evdash.domain.words import element_name
from evdash.files.bundled import bundled_scenarios
from evdash.files.run_export import RunLabel, Verdict, judge
from evdash.files.scenario_folder import read_scenario
from evdash.grid.acflow import ac_flow
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.ac import AcPoint
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.feeder import flows
from evdash.metrics.outlook import outlook
from evdash.metrics.records import executed_station_kw
from evdash.metrics.verdict import FULL_AC, LINEARISED
from evdash.metrics.verdict_words import sentences
from evdash.policies.race import race
from evdash.policies.race_words import race_sentences
from evdash.reports.account import account
from evdash.reports.html import report_html
from evdash.reports.words import limit_lines
from evdash.scheduling.p1 import p1_policy
from evdash.ui.feeder.words import moment_lines
from tests.app.test_feeder_page import told
from tests.app.test_live_page import clicked, opened, session
from tests.metrics.test_verdict import ALL_HOLD, at_clock

PRESETS = {folder.name: folder for folder in bundled_scenarios()}
DAYS = [(preset, network) for preset in PRESETS for network in ("lindistflow", "ac")]
CHARGING = r"(?:charging exceeds|charging worsens) (\d+) limit"
MODELS: dict[Network, str] = {
    LINEARISED: "In the linearised model",
    FULL_AC: "By AC power flow",
}


@dataclass(frozen=True)
class Refereed:
    """(element, interval) beyond a limit because of charging, and by the feeder itself; depths."""

    by_charging: set[tuple[str, int]]
    by_feeder: set[tuple[str, int]]
    deepest_pu: float
    deepest_kva: float

    @property
    def elements(self) -> set[str]:
        return {element for element, _ in self.by_charging}


def refereed(trace: Trace, network: Network) -> Refereed:
    """Voltages and loadings of the day in one model, with the station and without, held plainly."""
    scenario, station_kw = trace.scenario, executed_station_kw(trace)
    none = np.zeros(len(station_kw))
    if network == FULL_AC:
        loaded, base = ac_flow(scenario, station_kw), ac_flow(scenario, none)
        pairs = {
            f"voltage_min:{n}": scenario.feeder.voltage_min_pu
            - np.stack([loaded.voltage_pu[:, i], base.voltage_pu[:, i]])
            for i, n in enumerate(loaded.nodes)
        }
        pairs |= {
            f"voltage_max:{n}": np.stack([loaded.voltage_pu[:, i], base.voltage_pu[:, i]])
            - scenario.feeder.voltage_max_pu
            for i, n in enumerate(loaded.nodes)
        }
        pairs |= {
            f"line:{one.name}": np.stack([loaded.line_kva[:, i], base.line_kva[:, i]])
            - one.rating_kva
            for i, one in enumerate(scenario.lines)
            if one.rating_kva is not None
        }
    else:
        check = FeederCheck(scenario)
        sweeps = check.sweep(station_kw), check.sweep(none)
        volts = {n: np.sqrt([s.voltage_sq_pu[n] for s in sweeps]) for n in check.order[1:]}
        pairs = {f"voltage_min:{n}": scenario.feeder.voltage_min_pu - v for n, v in volts.items()}
        pairs |= {f"voltage_max:{n}": v - scenario.feeder.voltage_max_pu for n, v in volts.items()}
        pairs |= {
            f"line:{scenario.lines[row].name}": np.stack(
                [np.hypot(s.flow_kw[n], s.flow_kvar[n]) for s in sweeps]
            )
            - scenario.lines[row].rating_kva
            for n, row in check.line_of.items()
            if scenario.lines[row].rating_kva is not None
        }
    assert all(one.rating_kva is None for one in scenario.nodes)
    mine, own = set(), set()
    deepest = {"voltage": 0.0, "line": 0.0}
    for element, (over, without) in pairs.items():
        kind = element.partition(":")[0].partition("_")[0]
        least = 1e-6 if kind == "voltage" else 1e-3
        for t in np.flatnonzero(over > least):
            worsened = over[t] > max(0.0, without[t]) + least
            (mine if worsened else own).add((element, int(t)))
            if worsened:
                deepest[kind] = max(deepest[kind], float(over[t]))
    return Refereed(mine, own, deepest["voltage"], deepest["line"])


@dataclass(frozen=True)
class Judged:
    """A bundled day, the verdict on it, and what the referee found in either model."""

    trace: Trace
    verdict: Verdict
    found: dict[Network, Refereed]

    @property
    def told(self) -> list[str]:
        """Every sentence of the verdict, with plain clock times."""
        return [one.text for one in sentences(self.verdict.models, at_clock(self.trace))]


@pytest.fixture(scope="module", params=DAYS, ids=lambda day: f"{day[0]}-{day[1]}")
def judged(request: pytest.FixtureRequest) -> Judged:
    preset, network = request.param
    trace = run_day(start_day(read_scenario(PRESETS[preset]), network), p1_policy())
    verdict = judge(trace, linear_breaches(trace))
    return Judged(trace, verdict, {model: refereed(trace, model) for model in MODELS})


def test_both_verdicts_are_the_referees(judged: Judged) -> None:
    for model in judged.verdict.models:
        found = judged.found[model.network]
        assert {
            (str(v.element), t) for v in model.by_charging for t in v.intervals
        } == found.by_charging
        assert {
            (str(v.element), t) for v in model.by_feeder for t in v.intervals
        } == found.by_feeder
        for unit, deepest in (("pu", found.deepest_pu), ("kVA", found.deepest_kva)):
            depths = [v.depth for v in model.by_charging if v.unit == unit]
            assert max(depths, default=0.0) == pytest.approx(deepest, abs=1e-5)


def claims(text: str, judged: Judged) -> None:
    """Every claim of a text on limits is what the referee found, and nothing is left out."""
    holds = " ".join(re.findall(r"Every limit holds[^.]*", text))
    for network, model in MODELS.items():
        found = judged.found[network]
        counts = {int(n) for n in re.findall(f"{model}, {CHARGING}", text)}
        assert counts == ({len(found.elements)} if found.elements else set())
        assert (f"{model}, the feeder by itself" in text) == bool(found.by_feeder)
        assert (model[1:] in holds) == (not found.by_charging and not found.by_feeder)
        if found.deepest_kva:
            assert f"{found.deepest_kva:,.1f} kVA" in text
        if found.deepest_pu:
            assert f"{found.deepest_pu:.4f} pu" in text


def test_the_sentences(judged: Judged) -> None:
    claims("\n".join(judged.told), judged)
    if judged.trace.inputs.network == FULL_AC:
        assert "charging exceeds" not in "\n".join(judged.told)


def test_the_command_line(judged: Judged, capsys: pytest.CaptureFixture[str]) -> None:
    print_report(judged.trace, judged.verdict, label_of(judged.trace), None)
    claims(capsys.readouterr().out, judged)


def test_the_report(judged: Judged) -> None:
    told = account(judged.trace, judged.verdict, label_of(judged.trace))
    lines = limit_lines(told)
    claims("\n".join(text for _, text in lines), judged)
    states = {state for state, _ in lines}
    assert ("bad" in states) == any(found.by_charging for found in judged.found.values())
    page = unescape(report_html(told))
    assert all(text in page for _, text in lines)


def label_of(trace: Trace) -> RunLabel:
    return RunLabel("p1", trace.inputs.network, 1, 1.0)


def test_the_drawing_of_every_hour(judged: Judged) -> None:
    """Colour, label, alternative text and words of a line are of one mind, and of the referee's."""
    trace, ahead = judged.trace, outlook(judged.trace)
    flow, layout = flows(trace, ahead), layout_of(trace.scenario)
    for t in range(trace.now):
        moment = Moment(
            trace.scenario,
            ahead,
            flow,
            layout,
            t,
            linear=at(judged.verdict.linear, t),
            ac=AcPoint(
                judged.verdict.flow.voltage_pu[t],
                judged.verdict.flow.line_kva[t],
                at(judged.verdict.ac, t),
            ),
        )
        over = {network: outside(judged.found[network], t) for network in MODELS}
        figure = feeder_figure(moment)
        (red,) = [n["x"] for n in figure["data"] if n.get("name") == "Over its rating"] or [()]
        lines = {e for found in over.values() for e in found if e.startswith("line:")}
        assert len([x for x in red if x is None]) == len(lines)
        words = " ".join(moment_lines(moment, at_clock(trace)))
        for row, one in enumerate(trace.scenario.lines):
            percents = [float(p) for p in re.findall(r"([\d.]+) %", loading_told(moment, row))]
            assert any(p > 100 for p in percents) == (f"line:{one.name}" in lines)
        for network, mark in ((LINEARISED, "Outside limits"), (FULL_AC, "Outside limits in AC")):
            nodes = {e for e in over[network] if e.startswith("voltage")}
            drawn = [n for n in figure["data"] if n.get("name") == mark]
            assert sum(len(n["x"]) for n in drawn) == len(nodes)
            mine = {e for e, when in judged.found[network].by_charging if when == t}
            assert (f"{MODELS[network]}, charging" in words) == bool(mine)
            assert all(element_name(Element.read(e)) in feeder_alt(moment) for e in over[network])


def at(breaches: Sequence[Breach], interval: int) -> tuple[Breach, ...]:
    return tuple(one for one in breaches if one.interval == interval)


def outside(found: Refereed, interval: int) -> set[str]:
    return {element for element, t in found.by_charging | found.by_feeder if t == interval}


def test_the_race(judged: Judged) -> None:
    """The paper's rule alone: its lap is this day."""
    inputs = judged.trace.inputs
    raced = race(prepare(inputs.given, inputs.network), ("p1",))
    told = "\n".join(race_sentences(raced))
    for network, model in MODELS.items():
        found = judged.found[network]
        if found.by_charging:
            assert f"{model}, charging exceeds limits under every policy: p1 (" in told
        else:
            assert f"{model}, charging exceeds no limit under any policy." in told
        if found.deepest_kva:
            assert f"by {found.deepest_kva:,.1f} kVA" in told
        if found.deepest_pu:
            assert f"by {found.deepest_pu:.4f} pu" in told
    beyond = any(found.by_charging for found in judged.found.values())
    assert ("<br>over limits in AC" in profit_figure(raced)["data"][0]["y"][0]) == beyond
    assert ("(over limits in AC)" in profit_alt(raced)) == beyond


def test_a_click_keeps_the_limits_that_the_headline_says_are_exceeded() -> None:
    at = clicked(opened("summer-weekday"), "finish")
    assert told(at, "By AC power flow, charging exceeds 1 limit")
    assert session(at).run.trace.inputs.network == LINEARISED
    clicked(at, "again_in_ac")
    run = session(at).run.trace
    assert run.is_over
    assert run.inputs.network == FULL_AC
    assert told(at, ALL_HOLD)
    assert not any("charging exceeds" in text.value for text in at.markdown)
    assert "again_in_ac" not in {button.key for button in at.button}


def test_in_mid_day_the_click_keeps_them_from_now_on() -> None:
    at = clicked(opened("summer-weekday"), "step", 22)
    assert told(at, "By AC power flow, charging exceeds 1 limit")
    clicked(at, "rewire_to_ac")
    assert session(at).run.trace.inputs.network == FULL_AC
    assert session(at).run.trace.now == 22
    keys = {button.key for button in at.button}
    assert "rewire_to_ac" not in keys
    assert "again_in_ac" in keys, "the hours before were decided by the linearised model"
