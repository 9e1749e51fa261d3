"""Days without what every page counts on: nobody, no charger, no room, a single hour."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.domain.scenario import Scenario
from evdash.files.bundled import DEFAULT, PRESETS
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.scheduling.p1 import p1_policy
from evdash.ui import run as runs
from evdash.ui.model.card import NOBODY
from evdash.ui.session import KEY
from tests.builders import line, make_scenario, node, vehicle

ROOT = Path(__file__).parents[2]
PAGES = [path.stem for path in sorted((ROOT / "pages").glob("*.py"))]
POLICY = p1_policy()
ODD = {
    "no charger": lambda: edit_scenario(read_scenario(DEFAULT), {"station.chargers": 0}),
    "nobody comes": lambda: make_scenario(vehicles=()),
    "all come at once and too late": lambda: make_scenario(
        price=(0.1, 0.1), vehicles=[vehicle(f"v{n}", 1.5) for n in range(3)]
    ),
    "energy too dear for all": lambda: make_scenario(
        price=(9.0,) * 4, vehicles=[vehicle(f"v{n}", n / 2) for n in range(5)]
    ),
    "one interval": lambda: make_scenario(price=(0.1,), vehicles=[vehicle("v", 0.0, 5.0)]),
    "no room on the feeder": lambda: make_scenario(
        nodes=[{"node": "s"}, node("a", load_kw=90.0, load_kvar=0.0, rating_kva=50.0)],
        lines=[line("s", "a")],
        vehicles=[vehicle(f"v{n}") for n in range(3)],
    ),
    "a load of nothing": lambda: make_scenario(load=(0.0,) * 4, vehicles=[vehicle("v")]),
}


def open_day(scenario: Scenario, steps: int) -> AppTest:
    at = AppTest.from_file(str(ROOT / "app.py"), default_timeout=60)
    at.run()
    run = runs.open_run(None, scenario)
    for _ in range(steps):
        run = runs.stepped(run, POLICY)
    at.session_state[KEY].take(run)
    return at


@pytest.mark.parametrize("kind", ODD)
def test_every_page_is_shown_on_an_odd_day(kind: str) -> None:
    scenario = ODD[kind]()
    for steps in sorted({0, 1, scenario.intervals // 2, scenario.intervals}):
        at = open_day(scenario, steps)
        for page in PAGES:
            at.switch_page(f"pages/{page}.py").run()
            assert not at.exception, (kind, steps, page)


@pytest.mark.parametrize(
    ("scenario", "steps"),
    [
        (lambda: read_scenario(PRESETS / "price-spike"), 12),
        *((ODD[kind], 24) for kind in ODD),
    ],
    ids=["price-spike", *ODD],
)
def test_the_equations_of_every_hour_are_filled_in(scenario: object, steps: int) -> None:
    """Above all of hours in which nobody is served though somebody asks."""
    assert callable(scenario)
    at = open_day(scenario(), steps)
    at.switch_page("pages/model.py").run()
    slider = at.select_slider(key="model_hour")
    for hour in [option for option in slider.options if option != "…"]:
        at.session_state["model_hour"] = hour
        at.run()
        assert not at.exception, hour
        step = next(
            s
            for s in at.session_state[KEY].run.trace.steps
            if f"{s.inputs.scenario.time_of(s.interval):%H:%M}" in hour
        )
        asked = {*step.plan.vehicles, *(refusal.vehicle for refusal in step.plan.refused)}
        told = "\n".join(text.value for text in at.markdown)
        assert (NOBODY[1] in told) == (not asked)
