"""One run of the bundled day, shared by the tests that only read it."""

import shutil
from collections.abc import Callable
from pathlib import Path

import pytest

from evdash.cli.main import main
from evdash.files.scenario_folder import scenario_files
from tests.builders import line, make_scenario, node, vehicle


@pytest.fixture(scope="session")
def bundled_run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("runs") / "bundled"
    assert main(["run", "--out", str(directory)]) == 0
    return directory


@pytest.fixture(scope="session")
def small_scenario(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder: four hours on a line that can carry two vehicles beside the load."""
    scenario = make_scenario(
        name="small",
        nodes=[node("s"), node("a", load_kw=40), node("b", load_kw=20)],
        lines=[line("s", "a", rating=90.0), line("a", "b")],
        price=(0.1, 0.3, 0.2, 0.05),
        vehicles=[vehicle(f"V{n}", n / 4, need_kwh=12 + n) for n in range(12)],
    )
    folder = tmp_path_factory.mktemp("scenarios") / "small"
    folder.mkdir()
    for name, text in scenario_files(scenario).items():
        (folder / name).write_text(text, encoding="utf-8", newline="")
    return folder


@pytest.fixture(scope="session")
def small_run(small_scenario: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    directory = tmp_path_factory.mktemp("runs") / "small"
    assert main(["run", str(small_scenario), "--out", str(directory)]) == 0
    return directory


@pytest.fixture
def run_copy(small_run: Path, tmp_path: Path) -> Path:
    """A copy to be tampered with."""
    return Path(shutil.copytree(small_run, tmp_path / "run"))


@pytest.fixture
def command(capsys: pytest.CaptureFixture[str]) -> Callable[..., tuple[int, str, str]]:
    """Run a command line; its exit status, standard output and standard error."""

    def call(*arguments: object) -> tuple[int, str, str]:
        capsys.readouterr()
        try:
            status = main([str(argument) for argument in arguments])
        except SystemExit as stop:
            status = int(stop.code or 0)
        printed = capsys.readouterr()
        return status, printed.out, printed.err

    return call
