"""The AC check in the background when it fails: told on every page, and nobody waits for ever."""

import os
import re
import signal
import subprocess
import sys
import time
from collections import OrderedDict
from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.domain.trace import Trace
from evdash.files.bundled import DEFAULT, PRESETS
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.grid.acflow import AcNetwork
from evdash.horizon.day import start_day, step
from evdash.metrics import ac_kept
from evdash.metrics.ac import AcPoint, ac_point
from evdash.metrics.ac_kept import ATTEMPTS, KeptFlows
from evdash.metrics.ac_process import AcProcess
from evdash.metrics.key_figures import key_figures
from evdash.metrics.outlook import outlook
from evdash.metrics.verdict import ac_verdict
from evdash.metrics.verdict_words import sentences
from evdash.scheduling.p1 import p1_policy
from evdash.ui import referee as module
from evdash.ui.referee import Referee, referee
from evdash.ui.words import marked, wording
from tests.app.test_compare_page import day_of

ROOT = Path(__file__).parents[2]
APP = ROOT / "app.py"
FAILED = "could not be checked**: the AC power flow itself failed"
HOLDS_IN_AC = re.compile("Every limit holds.*AC")
SECONDS = 120.0


class Failing:
    """Pandapower in trouble: it fails so many times, then works."""

    def __init__(self, times: float) -> None:
        self.left = times

    def __call__(self, *asked: object) -> AcPoint:
        self.left -= 1
        if self.left >= 0:
            raise MemoryError("no [room] for <b>matrices</b>")
        return ac_point(*asked)


@pytest.fixture(autouse=True)
def at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "FIRST_PAGE_SECONDS", 0.0)


def failing(monkeypatch: pytest.MonkeyPatch, times: float) -> None:
    monkeypatch.setattr(ac_kept, "ac_point", Failing(times))


def day(steps: int) -> Trace:
    trace = start_day(read_scenario(DEFAULT))
    for _ in range(steps):
        trace = step(trace, p1_policy())
    return trace


def awaited(asked: Referee, trace: Trace) -> dict[int, AcPoint]:
    until = time.monotonic() + SECONDS
    while len(found := asked.findings(trace)) < len(trace.steps) and time.monotonic() < until:
        time.sleep(0.02)
    return found


def test_a_failure_is_a_finding_and_the_next_interval_is_checked(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failing(monkeypatch, ATTEMPTS)
    trace = day(2)
    found = awaited(Referee(KeptFlows()), trace)
    assert (found[0].checked, found[0].solved) == (False, False)
    assert found[1].solved
    figures = key_figures(trace, outlook(trace), found)
    assert (figures.ac_known, figures.ac_unchecked, figures.ac_breached) == (2, 1, 0)
    assert figures.lowest_ac_pu == pytest.approx(found[1].voltage_pu.min())
    (told,) = sentences([ac_verdict(found, 2)], wording(trace, outlook(trace)))
    line = marked(told)
    assert f"**1 interval {FAILED}" in line
    assert "<b>" not in line


def test_what_fails_once_is_tried_again_with_a_network_built_anew(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    failing(monkeypatch, 1)
    built: list[AcNetwork] = []

    class Counted(AcNetwork):
        def __init__(self, scenario: object) -> None:
            super().__init__(scenario)
            built.append(self)

    monkeypatch.setattr(ac_kept, "AcNetwork", Counted)
    found = awaited(Referee(KeptFlows()), day(1))
    assert found[0].solved
    assert len(built) == 2


def test_a_process_that_was_killed_is_begun_anew() -> None:
    flows = AcProcess()
    asked = Referee(flows)
    assert awaited(asked, day(1))[0].solved
    first = flows.pid
    assert first is not None
    os.kill(first, signal.SIGKILL)
    assert awaited(asked, day(2))[1].solved
    assert flows.pid != first


def test_an_answer_that_does_not_come_is_given_up_and_told() -> None:
    found = awaited(Referee(AcProcess(patience_seconds=0.05)), day(1))  # loading takes longer
    assert not found[0].checked
    assert "no AC power flow within 0.05 s" in found[0].failure


def test_the_process_finds_what_this_one_does() -> None:
    trace = start_day(read_scenario(PRESETS / "voltage-limited"))
    while not trace.is_over:
        trace = step(trace, p1_policy())
    there, here = awaited(Referee(AcProcess()), trace), awaited(Referee(KeptFlows()), trace)
    assert any(point.breaches for point in here.values())
    for interval, point in here.items():
        assert (there[interval].voltage_pu == point.voltage_pu).all()
        assert there[interval].breaches == point.breaches


def test_no_solution_comes_through_as_such() -> None:
    scenario = edit_scenario(read_scenario(DEFAULT), {"feeder.load_scale": 100.0})
    point = AcProcess().point(scenario, 12, 50.0)
    assert point.checked
    assert not point.solved


SERVER = """
import time
from evdash.files.bundled import DEFAULT, PRESETS
from evdash.files.scenario_folder import read_scenario
from evdash.metrics.ac_process import AcProcess
flows = AcProcess()
flows.prepare(read_scenario(DEFAULT), 0)
print(flows.pid, flush=True)
time.sleep(600)
"""


def test_the_process_ends_with_a_server_that_is_killed(tmp_path: Path) -> None:
    script = tmp_path / "server.py"
    script.write_text(SERVER, encoding="utf-8")
    with subprocess.Popen(
        [sys.executable, script],
        stdout=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": str(ROOT)},
    ) as server:
        child = int(server.stdout.readline())
        server.kill()
    until = time.monotonic() + SECONDS
    while alive(child) and time.monotonic() < until:
        time.sleep(0.05)
    assert not alive(child)


def alive(pid: int) -> bool:
    """Whether a process runs; one that ended and was not yet taken note of does not."""
    try:
        return "zombie" not in (Path("/proc") / str(pid) / "status").read_text()
    except OSError:
        return False


def app(page: str) -> AppTest:
    """A page with a step decided, on Compare held against another run."""
    at = AppTest.from_file(str(APP), default_timeout=120)
    at.query_params["preset"] = DEFAULT.name
    at.run()
    at.button(key="step").click().run()
    at.switch_page(f"pages/{page}.py").run()
    if page == "compare":
        at.button(key="pin").click().run()
        day_of(at, 1, station__chargers=1)
    return at


def texts(at: AppTest) -> str:
    return "\n".join(element.value for element in [*at.markdown, *at.caption])


def checked(at: AppTest) -> str:
    """What the page says once it waits for no interval any more."""
    until = time.monotonic() + SECONDS
    while "being checked" in texts(at) and time.monotonic() < until:
        time.sleep(0.1)
        at.run()
        assert not at.exception
    assert "being checked" not in texts(at)
    return texts(at)


@pytest.mark.parametrize("page", ["live", "feeder", "compare"])
def test_every_page_tells_it_and_waits_no_longer(
    monkeypatch: pytest.MonkeyPatch, page: str
) -> None:
    failing(monkeypatch, float("inf"))
    monkeypatch.setattr(referee, "_found", OrderedDict())
    monkeypatch.setattr(referee, "flows", KeptFlows())
    told = checked(app(page))
    assert ":red[:material/warning:" in told
    assert "could not be checked" in told
    assert not HOLDS_IN_AC.search(told)


@pytest.mark.parametrize("network", ["lindistflow", "ac"])
def test_no_ac_solution_is_told_in_red(network: str) -> None:
    """Loads a hundredfold: no voltages in AC, with the station or without it."""
    at = app("live")
    at.segmented_control(key="network").set_value(network).run()
    at = day_of(at, 2, feeder__load_scale=100)
    told = checked(at)
    assert "no solution even without charging, voltage may collapse**: in 2 intervals" in told
    assert "Every limit holds" not in told
    at.switch_page("pages/feeder.py").run()
    assert "Every limit holds" not in checked(at)
