"""A wheel of this checkout, installed beside nothing of it, runs a day and serves the app."""

import os
import re
import socket
import subprocess
import sys
import sysconfig
import time
import venv
import zipfile
from collections.abc import Iterator
from email.parser import HeaderParser
from pathlib import Path

import pytest

from benchmarks.crowd.server import ask
from evdash import __version__
from evdash.store.place import VARIABLE
from evdash.studies.code import code_version

ROOT = Path(__file__).parents[2]
PATIENCE_SECONDS = 240


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("wheel")
    command = [sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(made)]
    subprocess.run(command, cwd=ROOT, check=True, capture_output=True)
    return next(made.glob("*.whl"))


@pytest.fixture(scope="module")
def scripts(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Where the commands lie of an environment with the wheel in it, and what it depends on."""
    home = tmp_path_factory.mktemp("installed") / "venv"
    venv.create(home, with_pip=False, symlinks=os.name != "nt")
    paths = sysconfig.get_paths("venv", {"base": str(home), "platbase": str(home)})
    # the packages that are there already, after its own
    beside = Path(paths["purelib"]) / "beside.pth"
    beside.write_text(f"{sysconfig.get_path('purelib')}\n", encoding="utf-8")
    python = Path(paths["scripts"]) / "python"
    install = [sys.executable, "-m", "pip", "--python", str(python), "install", "-q"]
    subprocess.run([*install, "--no-deps", "--no-index", str(wheel)], check=True)
    return Path(paths["scripts"])


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Another folder to work in, with nothing that would lead back to this checkout."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.delenv("PYTHONPATH", raising=False)
    monkeypatch.setenv(VARIABLE, str(tmp_path / "store"))
    return tmp_path


def test_a_wheel_needs_what_the_requirements_say_and_carries_the_licence(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        names = archive.namelist()
        told = next(name for name in names if name.endswith("/METADATA"))
        metadata = HeaderParser().parsestr(archive.read(told).decode())
    lines = (ROOT / "requirements.txt").read_text(encoding="utf-8").split()
    assert sorted(map(parts, metadata.get_all("Requires-Dist") or [])) == sorted(map(parts, lines))
    assert metadata["Version"] == __version__
    assert metadata["License-Expression"] == "MIT"
    assert any(name.endswith("licenses/LICENSE") for name in names)
    assert not [name for name in names if "tests" in name or "__pycache__" in name]


def parts(requirement: str) -> list[str]:
    """A requirement's package and bounds, in an order of their own."""
    return sorted(re.findall(r"[<>]=?[\d.]+|^[\w-]+", requirement))


def test_an_installed_command_runs_a_day_from_another_folder(scripts, elsewhere) -> None:
    run = [str(scripts / "evdash"), "run", "price-spike", "--out", "a"]
    subprocess.run(run, check=True, capture_output=True)
    assert (elsewhere / "a" / "summary.json").is_file()
    told = (
        "import evdash, evdash.studies.code as c; print(evdash.__file__); print(c.code_version())"
    )
    python = [str(scripts / "python"), "-c", told]
    where, code = subprocess.run(python, check=True, capture_output=True, text=True).stdout.split()
    assert Path(where).is_relative_to(scripts.parent)
    assert code == code_version()  # a study goes on with either


def test_a_port_there_is_none_of_is_told(command) -> None:
    status, _, told = command("app", "--port", 65_536)
    assert status == 2
    assert "should be from 1 to 65535" in told


@pytest.fixture
def served(scripts: Path, elsewhere: Path) -> Iterator[tuple[str, Path]]:
    """The address of the installed app, and the file its server prints to."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    said = elsewhere / "said.txt"
    with said.open("wb") as out:
        command = [str(scripts / "evdash"), "app", "--headless", "--port", f"{port}"]
        server = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT)
    try:
        yield f"http://localhost:{port}", said
    finally:
        server.terminate()
        server.wait()


def answer(address: str) -> str:
    """What a server answers, once it does."""
    until = time.monotonic() + PATIENCE_SECONDS
    while True:
        try:
            return ask(address, 10).decode()
        except OSError:
            if time.monotonic() > until:
                raise
            time.sleep(0.2)


def test_the_installed_app_is_healthy_and_has_our_settings_and_pages(served) -> None:
    address, said = served
    assert answer(f"{address}/_stcore/health") == "ok"
    assert "BACKEND_BASE_URL" in answer(f"{address}/vehicles")  # evdash/ui/deep_links.py
    told = said.read_text(encoding="utf-8")
    assert f"evdash is open in the browser at\n\n    {address}" in told
    assert "You can now view" not in told  # hideWelcomeMessage of .streamlit/config.toml
