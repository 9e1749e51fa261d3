"""Folders that are written to: whatever interrupts it, nobody's files are lost."""

import json
import os
import subprocess
import sys
from collections.abc import Mapping
from pathlib import Path

import pytest

from evdash.errors import InputError
from evdash.files import exchange
from evdash.files.exchange import WORKSHOP, claimed, output_folder, put_files

ROOT = Path(__file__).parents[2]
OWN = ("summary.json", "a.csv", "b.csv", "scenario/a.csv", "scenario/b.csv")
LAST = "summary.json"
EARLIER = {"summary.json": "1", "a.csv": "1", "scenario/a.csv": "1", "scenario/b.csv": "1"}
FRESH = {"summary.json": "2", "a.csv": "2", "b.csv": "2", "scenario/a.csv": "2"}
MINE = {"notes.csv": "mine", "scenario/notes.txt": "mine", "sub/x.json": "mine"}
MOVES = len(EARLIER) + len(FRESH)
KILLED = 9


def lay(directory: Path, files: Mapping[str, str]) -> None:
    for name, text in files.items():
        (directory / name).parent.mkdir(parents=True, exist_ok=True)
        (directory / name).write_text(text, encoding="utf-8")


def found_in(directory: Path) -> dict[str, str]:
    files = [path for path in directory.rglob("*") if path.is_file()]
    return {p.relative_to(directory).as_posix(): p.read_text(encoding="utf-8") for p in files}


def write(directory: Path) -> None:
    with claimed(directory, "--out") as claim:
        claim.replace(FRESH, OWN, LAST)


def is_run(directory: Path) -> bool:
    return (directory / LAST).is_file()


def test_own_files_change_places_and_others_stay(tmp_path: Path) -> None:
    lay(tmp_path, EARLIER | MINE)
    write(tmp_path)
    assert found_in(tmp_path) == FRESH | MINE


class Interrupted:
    """`os.replace`, but for one call that raises instead, before or after its work."""

    def __init__(self, at: int, error: BaseException, after: bool) -> None:
        self.left, self.error, self.after = at, error, after

    def __call__(self, path: Path, to: Path) -> None:
        self.left -= 1
        if self.left == 0 and not self.after:
            raise self.error
        os.rename(path, to)
        if self.left == 0:
            raise self.error


@pytest.mark.parametrize("after", [False, True])
@pytest.mark.parametrize("error", [KeyboardInterrupt(), OSError(28, "No space left on device")])
@pytest.mark.parametrize("at", range(1, MOVES + 1))
def test_interrupted_anywhere_the_earlier_files_are_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: int, error: BaseException, after: bool
) -> None:
    lay(tmp_path, EARLIER | MINE)
    monkeypatch.setattr(exchange.os, "replace", Interrupted(at, error, after))
    with pytest.raises((KeyboardInterrupt, InputError)):
        write(tmp_path)
    whole = FRESH if at == MOVES and after else EARLIER
    assert found_in(tmp_path) == whole | MINE


KILL = """
import os, sys
from pathlib import Path
from tests.files import test_exchange as t
left, real = int(sys.argv[2]), os.replace
def replace(path, to):
    global left
    left -= 1
    if left == 0:
        os._exit(t.KILLED)
    real(path, to)
t.exchange.os.replace = replace
t.write(Path(sys.argv[1]))
"""


@pytest.mark.parametrize("at", [1, 2, len(EARLIER), len(EARLIER) + 1, MOVES, MOVES + 1])
@pytest.mark.parametrize("earlier", [EARLIER, {}], ids=["replaced", "new"])
def test_killed_anywhere_the_next_puts_it_right(
    tmp_path: Path, at: int, earlier: dict[str, str]
) -> None:
    """Nothing is left but what was there before; then the writing is done again."""
    lay(tmp_path, earlier | MINE)
    command = [sys.executable, "-c", KILL, str(tmp_path), str(at - len(EARLIER) + len(earlier))]
    status = subprocess.run(command, cwd=ROOT, check=False).returncode
    assert status == (KILLED if 0 < at - len(EARLIER) + len(earlier) <= len(earlier) + 4 else 0)
    with claimed(tmp_path, "--out"):
        pass
    assert found_in(tmp_path) == (earlier if status == KILLED else FRESH) | MINE
    write(tmp_path)
    assert found_in(tmp_path) == FRESH | MINE


@pytest.mark.parametrize("at", range(1, MOVES))
@pytest.mark.parametrize("again", range(1, MOVES))
def test_even_the_putting_right_can_be_interrupted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, at: int, again: int
) -> None:
    """As by a second Ctrl-C."""
    lay(tmp_path, EARLIER | MINE)
    settle = exchange.Claim.settle
    with monkeypatch.context() as patched:

        def hurried(claim: exchange.Claim) -> None:
            if (claim.workshop / exchange.LIST).exists():
                patched.setattr(os, "replace", Interrupted(again, KeyboardInterrupt(), True))
            settle(claim)

        patched.setattr(os, "replace", Interrupted(at, KeyboardInterrupt(), True))
        patched.setattr(exchange.Claim, "settle", hurried)
        with pytest.raises(KeyboardInterrupt):
            write(tmp_path)
    with claimed(tmp_path, "--out"):
        pass
    assert found_in(tmp_path) == EARLIER | MINE


def test_links_are_followed_and_stay(tmp_path: Path) -> None:
    lay(tmp_path / "real", EARLIER | MINE)
    (tmp_path / "link").symlink_to(tmp_path / "real")
    (tmp_path / "empty").mkdir()
    (tmp_path / "to-empty").symlink_to(tmp_path / "empty")
    (tmp_path / "nowhere").symlink_to(tmp_path / "made")
    for name, there in {"link": FRESH | MINE, "to-empty": FRESH, "nowhere": FRESH}.items():
        write(tmp_path / name)
        assert (tmp_path / name).is_symlink()
        assert found_in(tmp_path / name) == there
    assert found_in(tmp_path / "real") == FRESH | MINE


def test_a_circle_of_links_is_told(tmp_path: Path) -> None:
    (tmp_path / "a").symlink_to(tmp_path / "b")
    (tmp_path / "b").symlink_to(tmp_path / "a")
    with pytest.raises(InputError, match="cannot be written"):
        write(tmp_path / "a")


def test_a_folder_on_another_disk_is_written_there(tmp_path: Path) -> None:
    """As at a mount point: nothing is ever renamed across its edge."""
    with pytest.MonkeyPatch.context() as patched:
        moved: list[tuple[Path, Path]] = []
        real = os.replace
        patched.setattr(exchange.os, "replace", lambda a, b: (moved.append((a, b)), real(a, b))[1])
        lay(tmp_path / "disk", EARLIER)
        write(tmp_path / "disk")
    assert moved
    assert all((tmp_path / "disk") in path.parents for pair in moved for path in pair)


def test_a_claimed_folder_is_nobody_elses(tmp_path: Path) -> None:
    with claimed(tmp_path / "new", "--out new") as claim:
        with pytest.raises(InputError, match="another process"), claimed(tmp_path / "new", "x"):
            pass
        claim.replace(FRESH, OWN, LAST)
    assert found_in(tmp_path / "new") == FRESH


def test_a_place_that_cannot_be_written_is_told_before_the_work(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    for place in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc/evdash/run")):
        with pytest.raises(InputError), claimed(place, "--out"):
            raise AssertionError("work began")


def test_a_folder_made_for_nothing_is_taken_away(tmp_path: Path) -> None:
    with pytest.raises(ZeroDivisionError), claimed(tmp_path / "a" / "b", "--out"):
        raise ZeroDivisionError
    assert list(tmp_path.iterdir()) == []


def test_what_an_interrupted_writing_left_is_no_reason_to_refuse(tmp_path: Path) -> None:
    """A killed first writing leaves files without the one by which a run is known."""
    lay(tmp_path, {"a.csv": "2"})
    lay(tmp_path / WORKSHOP, {"files.json": json.dumps(["a.csv", LAST]), f"fresh/{LAST}": "2"})
    with output_folder(tmp_path, "run", is_run, force=False) as claim:
        assert found_in(tmp_path).keys() == {f"{WORKSHOP}/lock"}
        claim.replace(FRESH, OWN, LAST)
    assert found_in(tmp_path) == FRESH


def test_nothing_is_written_into_a_scenarios_folder(tmp_path: Path) -> None:
    lay(tmp_path, {"scenario.toml": ""})
    (tmp_path / "way-in").symlink_to(tmp_path)
    for place in (tmp_path, tmp_path / "runs", tmp_path / "way-in" / "a" / "b"):
        with (
            pytest.raises(InputError, match="inside the scenario folder"),
            output_folder(place, "run", is_run, force=True),
        ):
            pass
    assert {path.name for path in tmp_path.iterdir()} == {"scenario.toml", "way-in"}


def test_single_files_are_written_all_or_none_and_links_stay(tmp_path: Path) -> None:
    lay(tmp_path, {"real.html": "1"})
    (tmp_path / "link.html").symlink_to(tmp_path / "real.html")
    (tmp_path / "folder").mkdir()
    with pytest.raises(InputError, match="cannot be written"):
        put_files({tmp_path / "link.html": b"2", tmp_path / "real.html" / "x": b"2"})
    assert found_in(tmp_path) == {"real.html": "1", "link.html": "1"}
    put_files({tmp_path / "link.html": b"2", tmp_path / "new.html": b"2"})
    assert (tmp_path / "link.html").is_symlink()
    assert found_in(tmp_path) == {"real.html": "2", "link.html": "2", "new.html": "2"}
