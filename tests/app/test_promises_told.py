"""Broken promises are told everywhere from the moment they are known.

Ten of twelve chargers fail at 18:00. Who is short, and by how much, is worked out here from what
was promised and what flowed, once with the day run to its end by a program that no page has.
"""

import re

import pytest
from streamlit.testing.v1 import AppTest

from evdash.charts.fleet import fleet_alt, fleet_table
from evdash.charts.power_map import power_map
from evdash.charts.rows import rows_of
from evdash.charts.schedule import schedule_alt, schedule_figure, schedule_table
from evdash.cli.report import print_report
from evdash.domain.events import Event
from evdash.domain.trace import Trace
from evdash.files.bundled import DEFAULT
from evdash.files.run_export import RunLabel, judge
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.breaches import linear_breaches
from evdash.metrics.key_figures import key_figures
from evdash.metrics.outlook import outlook
from evdash.metrics.records import vehicle_records
from evdash.metrics.service import totals
from evdash.reports.account import account
from evdash.reports.words import promises_line
from evdash.scheduling.p1 import p1_policy
from evdash.ui.compare.figures import FIGURES, in_words
from evdash.ui.story import story
from evdash.ui.vehicles.words import STATUS_CELLS, title
from tests.app.test_events_panel import asked, panel
from tests.app.test_live_page import clicked, session

P1 = p1_policy()
SHORT = "Short of its promise"


@pytest.fixture(scope="module")
def before() -> Trace:
    trace = start_day(read_scenario(DEFAULT))
    while trace.now < 18:
        trace = step(trace, P1)
    return trace


@pytest.fixture(scope="module")
def known(before: Trace) -> Trace:
    """The moment the chargers fail: nothing is decided yet, no deadline has passed."""
    return happen(before, [Event(interval=18, event="chargers_fail", value=10)])


@pytest.fixture(scope="module")
def over(known: Trace) -> Trace:
    return run_day(known, P1)


@pytest.fixture(scope="module")
def missing(over: Trace) -> dict[str, float]:
    """kWh by vehicle under contract, of what it asked for less what flowed until the end."""
    got: dict[str, float] = {}
    for one in over.steps:
        for row, vehicle in enumerate(one.plan.vehicles):
            energy = float(one.plan.power_kw[row, 0]) * over.scenario.interval_hours
            got[vehicle] = got.get(vehicle, 0.0) + energy
    short = {
        request.vehicle: request.need_kwh - got.get(request.vehicle, 0.0)
        for one in over.steps
        for request in one.requests
        if request.vehicle in one.plan.admitted
    }
    return {vehicle: kwh for vehicle, kwh in short.items() if kwh > 0.01}


def plain_story(trace: Trace) -> str:
    told = story(trace, outlook(trace), totals(trace))
    return re.sub(r"[\\*]|\u2060", "", told).replace("\u00a0", " ")


def label(trace: Trace, vehicle: str) -> str:
    """What stands at the end of a vehicle's bar."""
    place = [row.request.vehicle for row in rows_of(trace)].index(vehicle)
    figure = schedule_figure(trace, outlook(trace))
    texts = {
        y: text
        for drawn in figure["data"]
        if drawn.get("mode") == "text"
        for y, text in zip(drawn["y"], drawn["text"], strict=True)
    }
    return texts[place]


def test_it_is_a_day_on_which_promises_break(missing: dict[str, float]) -> None:
    assert len(missing) == 6


@pytest.mark.parametrize("moment", ["known", "over"])
def test_headline_schedule_tables_and_words_name_the_same(
    moment: str, request: pytest.FixtureRequest, missing: dict[str, float]
) -> None:
    trace: Trace = request.getfixturevalue(moment)
    ahead, records = outlook(trace), vehicle_records(trace)
    whole = f"{sum(missing.values()):,.1f} kWh missing"
    head = {"known": "6 promises cannot be kept as things stand", "over": "6 promises broken"}
    assert f"{head[moment]}: {whole} for PEV-" in plain_story(trace)
    assert "known since 18:00: 10 of the chargers stop working" in plain_story(trace)
    short = {r.vehicle: r.short_kwh for r in records if r.short_kwh}
    assert short == pytest.approx(missing, abs=1e-6)
    rows = {str(row["Vehicle"]): row["Missing, kWh"] for row in schedule_table(trace, ahead)}
    assert {v: kwh for v, kwh in rows.items() if kwh} == pytest.approx(missing, abs=0.006)
    figure = schedule_figure(trace, ahead)
    (bars,) = [drawn for drawn in figure["data"] if drawn.get("name") == SHORT]
    assert len(bars["y"]) == 6
    assert all("of it missing" in told for told in bars["hovertext"])
    for row in rows_of(trace):
        marked = label(trace, row.request.vehicle).endswith(" !")
        assert marked == (row.request.vehicle in missing)
    assert "6 short" in schedule_alt(trace, ahead)
    assert "6 short" in fleet_alt(records, ahead)
    mapped = power_map(ahead, rows_of(trace), height_px=400)
    assert sum(len(d["y"]) for d in mapped["data"] if d.get("mode") == "markers") == 6
    assert "triangles: 6 short" in str(mapped["layout"]["annotations"])
    cells = {row["Vehicle"]: row["Answer"] for row in fleet_table(records, {}, STATUS_CELLS, ahead)}
    told = {v for v, cell in cells.items() if str(cell).startswith("!")}
    assert told == set(missing)
    for record in records:
        assert (":red-badge[:material/warning" in title(record)) == (record.vehicle in missing)
    figures = key_figures(trace, ahead, {})
    assert figures.broken == 6
    (broken,) = [one for one in FIGURES if one.label == "Broken promises"]
    assert broken.value(figures) == 6


def test_before_it_is_known_nobody_says_so(before: Trace) -> None:
    ahead = outlook(before)
    assert "promise" not in plain_story(before)
    figure = schedule_figure(before, ahead)
    assert SHORT not in {drawn.get("name") for drawn in figure["data"]}
    assert "short" not in schedule_alt(before, ahead)


def test_who_is_known_to_be_short_pays_for_what_it_gets(known: Trace, over: Trace) -> None:
    """Nobody new is admitted, so that the revenue is what it will be."""
    assert totals(known).revenue == pytest.approx(totals(over).revenue, abs=1e-6)


def test_report_and_command_line_count_the_same(
    over: Trace, missing: dict[str, float], capsys: pytest.CaptureFixture[str]
) -> None:
    verdict, name = judge(over, linear_breaches(over)), RunLabel("p1", "lindistflow", 1, 1.0)
    print_report(over, verdict, name, None)
    printed = re.findall(r"^broken: (\S+) got", capsys.readouterr().out, re.MULTILINE)
    assert set(printed) == set(missing)
    assert promises_line(account(over, verdict, name))[1].endswith("6 promises broken.")


def test_a_comparison_says_what_was_earned_beyond_promises(before: Trace, known: Trace) -> None:
    figures = [key_figures(trace, outlook(trace), {}) for trace in (before, known)]
    assert "It breaks 6 promises, against 0." in in_words(*figures, "b", "a")
    assert "promise" not in in_words(figures[0], figures[0], "b", "a")


def tile(at: AppTest) -> tuple[str, str]:
    (found,) = [one for one in at.metric if one.label == "Broken"]
    return found.value, found.delta


def test_the_page_tells_it_at_once(missing: dict[str, float]) -> None:
    at = panel()
    assert tile(at) == ("0", "of 30 promises")
    clicked(asked(at, "chargers_fail", count=10), "event_apply")
    assert session(at).run.trace.now == 18
    assert tile(at) == ("6", f"{sum(missing.values()):,.1f} kWh")
    told = "\n".join(str(one.value) for one in at.markdown)
    assert "**6 promises cannot be kept as things stand**" in told
    at.switch_page("pages/vehicles.py").run()
    assert any("6 promises cannot be kept" in str(one.value) for one in at.markdown)


def test_drivers_who_give_up_a_part_are_not_said_to_be_charged_in_full(before: Trace) -> None:
    (leaving,) = [c for c in before.state.contracts if c.vehicle == "PEV-026"]
    event = Event(interval=18, event="leaves_early", subject=leaving.vehicle, until_interval=19)
    over = run_day(happen(before, [event]), P1)
    assert totals(over).released == 1
    assert "every promise kept, 1 cut short by their drivers" in plain_story(over)
    assert "charged in full" not in plain_story(over)
