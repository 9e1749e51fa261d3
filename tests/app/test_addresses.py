"""Addresses nobody has written on purpose: the page says what is wrong or begins a new day."""

from pathlib import Path

import pytest
from streamlit.testing.v1 import AppTest

from evdash.files.bundled import bundled_scenarios
from evdash.store.runs import new_link
from evdash.ui.keeping import GONE, LINK
from evdash.ui.session import PRESET
from evdash.ui.studies.mine import OWNER
from evdash.ui.vehicles.picked import VEHICLE
from tests.app.test_live_page import clicked

ROOT = Path(__file__).parents[2]
HOSTILE = ("../../etc/passwd", "' OR 1=1 --", "<img src=x onerror=alert(1)>", "n" * 5000, "a\x00b")
UI = ROOT / "evdash" / "ui"


def opened(page: str = "", **query: str) -> AppTest:
    app = AppTest.from_file(str(ROOT / "app.py"), default_timeout=120)
    for name, value in query.items():
        app.query_params[name] = value
    app.run()
    if page:
        app.switch_page(f"pages/{page}.py").run()
    assert not app.exception
    return app


def told(app: AppTest) -> str:
    kinds = (app.caption, app.warning, app.markdown, app.error, app.info)
    return " ".join(one.value for kind in kinds for one in kind).replace("\\", "")


@pytest.mark.parametrize("text", HOSTILE)
def test_hostile_texts_in_an_address_open_a_page_without_an_error(text: str) -> None:
    app = opened(**dict.fromkeys((LINK, PRESET, OWNER, VEHICLE, "unknown"), text))
    assert GONE in told(app)


def test_a_preset_there_is_none_of_is_told_with_those_there_are() -> None:
    said = told(opened(preset="sumer-weekday"))
    assert "asks for a preset called sumer-weekday, and there is none" in said
    assert "was opened. Presets are" in said
    for folder in bundled_scenarios():
        assert folder.name in said
        assert "there is none" not in told(opened(preset=folder.name))
    assert "there is none" not in told(opened())


def test_it_is_told_beside_a_run_that_is_gone_but_not_where_the_run_is_there() -> None:
    gone = told(opened(run="nobodys", preset="sumer-weekday"))
    assert GONE in gone
    assert "there is none" in gone
    link = clicked(opened(), "step").run().query_params[LINK]
    assert "there is none" not in told(opened(run=link, preset="sumer-weekday"))


@pytest.mark.parametrize("page", ["live", "vehicles", "feeder", "model"])
def test_an_unknown_preset_is_told_whatever_page_it_leads_to(page: str) -> None:
    assert "there is none" in told(opened(page, preset="sumer-weekday"))


def test_studies_that_are_not_there_are_told() -> None:
    assert "../x in this address is no name of studies" in told(opened("studies", studies="../x"))
    assert "No studies are kept under this address" in told(opened("studies", studies=new_link()))
    assert "this address" not in told(opened("studies"))


def test_a_vehicle_that_is_not_there_is_told() -> None:
    app = opened("vehicles", vehicle="V4711")
    assert "V4711 has not asked yet either" in told(app).replace("*", "")
    clicked(app, "first_step")
    assert "V4711 has not asked by" in told(app).replace("*", "")


def test_nothing_else_reads_an_address() -> None:
    """Whoever reads another key of an address adds what is said of a value that means nothing."""
    readers = {
        file.relative_to(UI).as_posix()
        for file in UI.rglob("*.py")
        if "query_params.get(" in file.read_text(encoding="utf-8")
    }
    assert readers == {"page.py", "session.py", "studies/mine.py", "vehicles/picked.py"}
