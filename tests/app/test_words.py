"""The sentences: true to the trace, in plain words, and safe whatever things are called."""

import re

import pytest

from evdash.domain.elements import Element
from evdash.domain.plan import SolveReport
from evdash.domain.refusal import CLAUSES
from evdash.domain.trace import Trace
from evdash.files.bundled import DEFAULT, PRESETS
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.revise import revise
from evdash.metrics.outlook import outlook
from evdash.metrics.records import interval_records
from evdash.metrics.service import totals
from evdash.scheduling.p1 import p1_policy
from evdash.ui.story import story
from evdash.ui.words import decision_lines, element_words, money, plain, quality
from tests.builders import line, make_scenario, node, vehicle

P1 = p1_policy()


@pytest.fixture(scope="module")
def day() -> Trace:
    return start_day(read_scenario(DEFAULT))


def told(trace: Trace) -> str:
    return (
        story(trace, outlook(trace), totals(trace))
        .replace("\\", "")
        .replace("*", "")
        .replace("\u00a0", " ")
    )


def test_the_story_follows_the_day(day: Trace) -> None:
    assert told(day).startswith("The day is about to begin. Line or transformer 633–634 (500 kVA)")
    assert "18:00 will be its tightest hour, 61 kW left" in told(day)
    trace = day
    for _ in range(14):
        trace = step(trace, P1)
    sums = totals(trace)
    charging = int(trace.steps[-1].plan.charging[0])
    assert told(trace).startswith(
        f"{sums.admitted} of {sums.arrived} PEVs admitted, {charging} charging."
    )
    for _ in range(5):
        trace = step(trace, P1)
    assert "The feeder's tightest hour is behind: 18:00 left 61 kW." in told(trace)
    over = run_day(trace, P1)
    assert "51 of 99 PEVs admitted, every one charged in full and on time" in told(over)


def test_a_day_that_is_over_says_why_everyone_was_refused_and_what_was_used_up(day: Trace) -> None:
    over = run_day(day, P1)
    said = told(over)
    numbers = re.findall(r"\((\d+)\)", said[said.index("Refused:") : said.index(" All chargers")])
    assert sum(map(int, numbers)) == totals(over).refused == 48
    assert f"{CLAUSES['after the end']} (7)" in said
    busy = sum(step.plan.charging[0] == 12 for step in over.steps)
    assert f"All chargers were in use in {busy} of 24 hours; the feeder was full in" in said
    records = interval_records(over)
    full = sum(r.headroom_kw - r.station_kw <= max(0.05, 1e-3 * r.headroom_kw) for r in records)
    assert f"the feeder was full in {full}: at" in said
    few = told(run_day(start_day(edit_scenario(day.scenario, {"station.chargers": 2})), P1))
    assert "the feeder was never full" in few
    nobody = start_day(edit_scenario(day.scenario, {"station.chargers": 0}))
    assert told(nobody).endswith("The station has no chargers.")
    assert "every one" not in told(run_day(nobody, P1))
    two = start_day(edit_scenario(day.scenario, {"station.chargers": 2}))
    assert "limits nothing: it leaves at least 61 kW, and 2 chargers can draw 38 kW" in told(two)


def test_a_day_that_is_over_is_told_as_it_was_whatever_is_set_for_its_next_run(day: Trace) -> None:
    over = run_day(day, P1)
    without = revise(over, edit_scenario(over.scenario, {"station.chargers": 0}))
    assert (
        told(without).partition("All chargers")[2] == told(over).partition("All chargers")[2] != ""
    )


def test_the_decision_names_who_was_refused_and_why(day: Trace) -> None:
    trace = run_day(day, P1)
    evening = trace.steps[21]
    lines = decision_lines(evening, outlook(trace))
    assert lines[0] == f"**{len(evening.requests)} vehicles asked:** " + (
        f"{len(evening.plan.admitted)} admitted, {len(evening.plan.refused)} refused."
    )
    reasons = {plain(refusal.reason.clause) for refusal in evening.plan.refused}
    for reason in reasons:
        assert any(reason in text for text in lines)
    assert "Proven optimal to within 1 cent" in lines[-1]


def test_quality_is_told_in_plain_words() -> None:
    assert "1 cent" in quality(SolveReport("optimal", -5.0, -5.001, 0.2))
    assert "\\$0.55" in quality(SolveReport("feasible", -5.0, -5.55, 20.0))
    assert "not proven" in quality(SolveReport("feasible", -5.0, None, 20.0))
    assert "previous plan" in quality(SolveReport("fallback", 1.0, None, 0.0, "no plan"))


@pytest.mark.parametrize(
    "name", ["x*b*", "a[l](http://e.example)", "c$x$", "d:red[no]", "e`f`", "g<b>"]
)
def test_names_cannot_become_markup(name: str) -> None:
    scenario = make_scenario(
        nodes=[node("s"), node(name)],
        lines=[line("s", name, rating=50)],
        station={"node": name},
        vehicles=[vehicle(name), vehicle(f"{name}2", need_kwh=39.0)],
    )
    trace = step(start_day(scenario), P1)
    everything = [
        story(trace, outlook(trace), totals(trace)),
        *decision_lines(trace.steps[0], outlook(trace)),
        element_words(Element("voltage_min", name), scenario),
        element_words(Element("line", "s", name), scenario),
    ]
    for text in everything:
        assert name not in text
    assert plain(name) in everything[-1]


def test_plain_text_has_no_live_punctuation() -> None:
    assert not re.search(r"(?<!\\)[*_\[\]$:<`]", plain("a*b_c[d]$e:f<g`h"))


def test_money_has_two_digits_and_one_sign() -> None:
    assert money(1234.5) == "\\$1,234.50"
    assert money(-0.004) == "\\$0.00"
    assert money(-3) == "−\\$3.00"


def test_hours_in_which_the_feeder_leaves_nothing_count_as_full() -> None:
    day = read_scenario(PRESETS / "voltage-limited")
    said = told(run_day(start_day(day, "ac"), P1))
    assert "the feeder was full in 5 of 24 hours: at 17:00 the lowest voltage" in said
    assert said.endswith("allowed nothing.")
