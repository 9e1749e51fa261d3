"""The page on architecture: the way it tells is the way code goes, and all it names is there."""

import importlib
import re
import sys
import threading
from pathlib import Path
from types import FrameType

from docs import build_architecture as built
from evdash.cli.main import main
from evdash.files.scenario_folder import scenario_files
from tests.builders import make_scenario, vehicle

ROOT = Path(__file__).parent.parent


def test_the_page_and_its_drawing_are_as_built() -> None:
    for name, text in built.files().items():
        assert (ROOT / "docs" / name).read_text(encoding="utf-8") == text


def test_every_room_is_in_it_and_drawn_in_its_layer() -> None:
    rooms = {p.name.removesuffix(".py") for p in (ROOT / "evdash").iterdir()}
    rooms -= {"__init__", "__main__", "__pycache__", "resources"}
    assert set(built.ROOMS) == rooms
    assert {room for layer in built.layers() for room in layer} == rooms


def test_every_file_and_function_it_names_is_there() -> None:
    named = re.findall(r"`(evdash/[\w/]+\.py)`(?: `(\w+)`)?", built.page())
    assert len(named) > len(built.WAY)
    for file, name in named:
        assert (ROOT / file).is_file(), file
        if name:
            module = importlib.import_module(file.removesuffix(".py").replace("/", "."))
            assert hasattr(module, name), (file, name)


def test_a_day_and_its_report_go_the_way_that_is_told(tmp_path: Path, capsys) -> None:
    scenario, run, report = (tmp_path / name for name in ("scenario", "run", "report.html"))
    scenario.mkdir()
    day = make_scenario(vehicles=[vehicle("PEV-001")])
    for name, text in scenario_files(day).items():
        (scenario / name).write_text(text, encoding="utf-8", newline="")
    stages = {stage.function: None for stage in built.WAY}
    entered: dict[str, None] = {}

    def heard(frame: FrameType, event: str, _: object) -> None:
        if event == "call":
            name = f"{frame.f_globals.get('__name__')}.{frame.f_code.co_name}"
            if name in stages:
                entered.setdefault(name)

    threading.setprofile(heard)
    sys.setprofile(heard)
    try:
        assert main(["run", str(scenario), "--out", str(run)]) == 0
        assert main(["audit", str(run)]) == 0
        assert main(["export", str(run), "--report", str(report)]) == 0
    finally:
        sys.setprofile(None)
        threading.setprofile(None)  # type: ignore[arg-type]
    capsys.readouterr()
    assert list(entered) == list(stages)
    assert "PEV-001" in report.read_text(encoding="utf-8")
