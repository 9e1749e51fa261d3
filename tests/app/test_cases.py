"""Prepared cases: pressed as a lecturer presses them, and every claim held against that run."""

import re
from functools import cache
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from streamlit.testing.v1 import AppTest

from evdash.cli.main import main
from evdash.domain.trace import Trace
from evdash.files.bundled import bundled_scenarios
from evdash.files.numbers import number_text
from evdash.grid.acflow import ac_flow
from evdash.metrics.service import totals
from evdash.ui.cases.case import Case, Claim, Walk, seen
from evdash.ui.cases.doing import Doing, Finish, StepUntil
from evdash.ui.cases.lecture import CASES
from evdash.ui.session import bundled, bundled_names
from tests.app.test_live_page import clicked, now, opened, opened_texts, session

PRESETS = [folder.name for folder in bundled_scenarios()]
NAMES = {case.preset: case for case in CASES}
CHOSEN = ("price_curve", "network")


@cache
def walked(number: int, preset: str = "") -> Walk:
    return CASES[number].walk(preset)


EVERY_CLAIM = [
    pytest.param(number, claim, id=f"{case.preset}: {claim.told[:30]}")
    for number, case in enumerate(CASES)
    for claim in case.claims
]


@pytest.mark.parametrize(("number", "claim"), EVERY_CLAIM)
def test_every_claim_holds_on_its_run(number: int, claim: Claim) -> None:
    figures = claim.figures(walked(number))
    assert claim.holds(figures), figures
    sentence = claim.sentence(walked(number))
    assert sentence is not None
    assert not re.search(r"[{}]|nan|inf\b|never", sentence)


@pytest.mark.parametrize(("number", "claim"), EVERY_CLAIM)
def test_no_claim_holds_whatever_the_day(number: int, claim: Claim) -> None:
    others = [name for name in PRESETS if name != CASES[number].preset]
    opened_day, first = walked(number).runs[:2]
    no_more_pressed = Walk((opened_day, *[Finish().done(first)] * len(CASES[number].press)))
    there = [no_more_pressed, *(walked(number, preset) for preset in others)]
    assert None in [claim.sentence(walk) for walk in there], "it would be told of any day"


def test_lessons_that_are_false_are_caught() -> None:
    """The morals of an earlier version: each is contradicted by the run it spoke of."""
    false = (
        (0, "two chargers are not missed", lambda w: w.runs[3].answer is None),
        (
            3,
            "a shorter promise admits more",
            lambda w: totals(w.after(2)).admitted >= totals(w.after(1)).admitted,
        ),
    )
    for number, told, so in false:
        claim = Claim(told, lambda walk, so=so: {"so": so(walk)}, lambda n: bool(n["so"]))
        assert claim.sentence(walked(number)) is None
        true = CASES[number]
        told_now = seen(Case("?", true.preset, "", true.press, (claim, true.claims[0]), ""))
        assert told_now[0] == f"- {true.claims[0].sentence(walked(number))}"


@pytest.mark.parametrize("claim", [c for case in CASES for c in case.claims], ids=lambda c: c.told)
def test_no_number_in_a_sentence_is_typed(claim: Claim) -> None:
    literal = re.sub(r"\{[^}]*\}|\d\d:00|\bC[12]\b", "", claim.told)
    assert not re.search(r"\d", literal)
    assert re.search(r"\{\w+", claim.told)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.preset)
def test_what_is_told_without_figures_has_no_number(case: Case) -> None:
    for told in (case.question, case.about, case.why):
        assert not re.search(r"\d", re.sub(r"\bC[12]\b", "", told))


def pressed(at: AppTest, doing: Doing) -> None:
    """Do in the page what a case has a lecturer do, with the widget that is named so."""
    value = getattr(doing, "value", None)
    if doing.key == "why":
        widget = at.selectbox(key="why")
        assert widget.label == doing.label
        widget.select_index(0).run()
    elif doing.key in CHOSEN:
        widget = at.segmented_control(key=doing.key)
        assert widget.label == doing.label
        widget.set_value(value).run()
    elif value is not None:
        widget = at.text_input(key=doing.key)
        assert widget.label.startswith(doing.label)
        widget.set_value(number_text(value)).run()
    else:
        button = at.button(key=doing.key)
        assert button.label.replace("\\", "").startswith(doing.label)
        assert not button.disabled
        times = doing.steps(session(at).run) if isinstance(doing, StepUntil) else 1
        clicked(at, doing.key, times)
    assert not at.exception


def decided(trace: Trace) -> list[object]:
    """All that was decided, and under which inputs."""
    return [trace.inputs.scenario.model_dump(mode="json"), trace.inputs.network] + [
        (step.plan.admitted, step.plan.refused, step.plan.vehicles, step.plan.power_kw.tolist())
        for step in trace.steps
    ]


@pytest.mark.parametrize("number", range(len(CASES)), ids=list(NAMES))
def test_pressed_in_the_page_a_case_comes_out_as_it_is_worked_out(number: int) -> None:
    case, walk = CASES[number], walked(number)
    at = opened(steps=1)
    clicked(at, "cases")
    clicked(at, f"case_{number}").run()
    assert now(at) == 0
    assert session(at).run.folder == bundled_names()[case.preset]
    for press, there in zip(case.press, walk.runs[1:], strict=True):
        for doing in press.doing:
            pressed(at, doing)
        assert decided(session(at).run.trace) == decided(there.trace), press.told
        assert session(at).run.answer == there.answer
    told = opened_texts(at, f"case_answer_{number}")
    assert "\n".join(f"- {claim.sentence(walk)}" for claim in case.claims) in told
    assert f"**Why?** {case.why}" in told
    clicked(at, "close_case")
    assert not any(case.question in text.value for text in at.markdown)


def test_a_case_says_where_another_day_is_open() -> None:
    at = clicked(opened(), "cases")
    clicked(at, "case_1").run()
    other = "Another day is open"
    assert not any(other in text.value for text in at.caption)
    at.selectbox(key="preset").set_value("winter-weekday").run()
    name = bundled(bundled_names()["price-spike"]).name
    assert any(other in text.value and name in text.value for text in at.caption)


def files(folder: Path, preset: str, *options: str) -> dict[str, pd.DataFrame]:
    """The tables a day run on the command line leaves, with clock times."""
    source = bundled_names()[preset]
    assert main(["run", str(source), *options, "--out", str(folder)]) == 0
    tables = {name: pd.read_csv(folder / f"{name}.csv") for name in ("intervals", "vehicles")}
    tables["power"] = pd.read_csv(folder / "power.csv")
    tables["intervals"]["clock"] = tables["intervals"].start.str[11:16]
    return tables


def figures(number: int, claim: int) -> dict[str, object]:
    return dict(CASES[number].claims[claim].figures(walked(number)))


def test_figures_of_scarcity_are_those_of_the_files(tmp_path: Path) -> None:
    intervals = files(tmp_path / "day", "summer-weekday")["intervals"].set_index("clock")
    evening, night = intervals.loc["19:00"], intervals.loc["22:00"]
    told = figures(0, 0)
    assert told["headroom_kw"] == pytest.approx(evening.headroom_kw, abs=1e-9)
    assert (told["asked"], told["refused"]) == (evening.arrived, evening.refused)
    assert told["idle"] == 12 - evening.charging
    told = figures(0, 2)
    assert told["left_kw"] == pytest.approx(night.headroom_kw - night.station_kw, abs=1e-9)
    assert told["in_use"] == night.charging
    assert told["refused"] == night.refused


def test_figures_of_the_spike_are_those_of_the_files(tmp_path: Path) -> None:
    day = files(tmp_path / "spike", "price-spike")
    intervals, vehicles, power = day["intervals"], day["vehicles"], day["power"]
    within = intervals[(intervals.clock >= "13:00") & (intervals.clock < "20:00")]
    assert figures(1, 1)["kwh"] == pytest.approx(within.station_kw.sum(), abs=1e-9)
    assert figures(1, 1)["asked"] == within.arrived.sum()
    dear = intervals[intervals.price_per_kwh > 0.35]
    assert figures(1, 0)["low"] == dear.price_per_kwh.min()
    assert figures(1, 0)["high"] == dear.price_per_kwh.max()
    waited = vehicles[(vehicles.status == "charged") & vehicles.arrival_interval.between(18, 20)]
    theirs = power[power.vehicle.isin(waited.vehicle)]
    late = theirs[theirs.interval >= 21].power_kw.sum() / theirs.power_kw.sum()
    assert figures(1, 2) == {"admitted": len(waited), "share": pytest.approx(100 * late)}
    ordinary = files(tmp_path / "ordinary", "summer-weekday")["vehicles"]
    assert figures(1, 3)["spike"] == (vehicles.status == "charged").sum()
    assert figures(1, 3)["ordinary"] == (ordinary.status == "charged").sum()


def test_figures_of_the_voltage_are_those_of_the_files(tmp_path: Path) -> None:
    preset = "voltage-limited"
    linear = files(tmp_path / "linear", preset)["intervals"]
    ac = files(tmp_path / "ac", preset, "--network", "ac")["intervals"]
    assert figures(2, 0)["in_use"] == linear.charging.max()
    assert figures(2, 0)["least_kw"] == pytest.approx(linear.headroom_kw.min(), abs=1e-9)
    least = (linear.headroom_kw - ac.headroom_kw).min()
    assert figures(2, 2)["least_more_kw"] == pytest.approx(least, abs=1e-9)
    assert (figures(2, 2)["linear"], figures(2, 2)["ac"]) == (
        linear.admitted.sum(),
        ac.admitted.sum(),
    )
    assert ac[ac.headroom_kw < 0.05].clock.tolist() == ["16:00", "17:00", "18:00", "19:00"]
    voltages = pd.read_csv(tmp_path / "linear" / "voltages.csv")
    behind = voltages[voltages.node == "652"].set_index("interval").loc[12:]
    assert (behind.voltage_pu > behind.voltage_ac_pu).all()
    # pandapower, without the station
    flow = ac_flow(bundled(bundled_names()[preset]), np.zeros(24))
    low = flow.voltage_pu.min(axis=1) < 0.97
    assert np.flatnonzero(low).tolist() == [16, 17, 18, 19]


def test_figures_of_speed_are_those_of_the_files(tmp_path: Path) -> None:
    preset, share = "past-midnight", "arrivals.option_share"
    days = {
        "slow": files(tmp_path / "slow", preset),
        "fast": files(tmp_path / "fast", preset, "--set", "option.C2.average_kw=9.6"),
        "dear": files(
            tmp_path / "dear", preset, "--set", f"{share}.C1=1.0", "--set", f"{share}.C2=0.0"
        ),
    }
    charged = {name: (day["vehicles"].status == "charged").sum() for name, day in days.items()}
    profit = {
        name: day["vehicles"].revenue.sum()
        - (day["intervals"].station_kw * day["intervals"].price_per_kwh).sum()
        for name, day in days.items()
    }
    night = {
        name: day["intervals"].query("interval >= 24").station_kw.sum()
        for name, day in days.items()
    }
    assert (figures(3, 0)["slow"], figures(3, 0)["fast"]) == (charged["slow"], charged["fast"])
    assert figures(3, 0)["slow_profit"] == pytest.approx(profit["slow"], abs=1e-6)
    assert figures(3, 0)["fast_profit"] == pytest.approx(profit["fast"], abs=1e-6)
    assert figures(3, 1)["slow_kwh"] == pytest.approx(night["slow"], abs=1e-6)
    assert figures(3, 1)["fast_kwh"] == pytest.approx(night["fast"], abs=1e-6)
    assert figures(3, 2)["admitted"] == charged["dear"]
    assert figures(3, 2)["profit"] == pytest.approx(profit["dear"], abs=1e-6)
