"""A folder that is written to: claimed before any work is done, changed whole or not at all.

Fresh files are laid out in a folder of our own inside the target, which works on any disk and at a
mount point, and shows at once whether the place can be written. Then they change places with those
of an earlier writing. Whatever interrupts that is put right: at once, or, where the process was
killed, by whoever claims the folder next. Files that are not ours stay where they are.
"""

import json
import os
import shutil
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from filelock import FileLock, Timeout

from evdash.errors import Fault, InputError
from evdash.files.folder import WORKSHOP
from evdash.files.scenario_folder import SETTINGS

LOCK, FRESH, EARLIER, LIST = "lock", "fresh", "earlier", "files.json"


@dataclass(frozen=True, slots=True)
class Claim:
    """A folder of which this process alone changes the files; `place` names it in messages."""

    directory: Path
    place: str

    @property
    def workshop(self) -> Path:
        return self.directory / WORKSHOP

    def replace(self, files: Mapping[str, str | bytes], own: Collection[str], last: str) -> None:
        """Put `files` (path below the folder to content) in place of an earlier writing's.

        `own` names all that an earlier one may have written: those files go. The file named
        `last`, by which the folder is known, is the first to go and the last to come.
        """
        names = sorted(files, key=lambda name: name == last)
        earlier = sorted(own, key=lambda name: name != last)
        try:
            for name in names:
                _write(self.workshop / FRESH / name, files[name])
            _write(self.workshop / LIST, json.dumps(names))
            for name in earlier:
                if (self.directory / name).is_file():
                    _move(self.directory / name, self.workshop / EARLIER / name)
            for name in names:
                _move(self.workshop / FRESH / name, self.directory / name)
        except OSError as error:
            raise unwritable(self.place, error) from error

    def settle(self) -> None:
        """End an exchange: complete, the earlier files go; interrupted, they come back.

        Whenever this itself is interrupted, doing it again goes on from there.
        """
        fresh, earlier, listed = (self.workshop / name for name in (FRESH, EARLIER, LIST))
        if listed.is_file():
            names = json.loads(listed.read_text(encoding="utf-8"))
            placed = [name for name in names if not (fresh / name).exists()]
            if len(placed) < len(names):
                for name in placed:
                    _move(self.directory / name, fresh / name)
                for path in [each for each in earlier.rglob("*") if each.is_file()]:
                    _move(path, self.directory / path.relative_to(earlier))
            listed.unlink()
        shutil.rmtree(self.workshop / FRESH, ignore_errors=True)
        shutil.rmtree(self.workshop / EARLIER, ignore_errors=True)


@contextmanager
def claimed(directory: Path, place: str) -> Iterator[Claim]:
    """Claim a folder, made if need be, for as long as the work takes; links are followed.

    What a killed process left half exchanged is put right first. A folder made for nothing is
    taken away again. Raises InputError where the place cannot be written or is claimed already.
    """
    target = resolved(directory, place)
    claim = Claim(target, place)
    lock = FileLock(claim.workshop / LOCK, timeout=0)
    try:
        made = [each for each in (target, *target.parents) if not each.exists()]
        claim.workshop.mkdir(parents=True, exist_ok=True)
        lock.acquire()
    except Timeout:
        found = "a folder that another process of evdash is about to write to"
        raise InputError([Fault(place, found, "wait for it, or name another folder")]) from None
    except OSError as error:
        raise unwritable(place, error) from error
    try:
        claim.settle()
        yield claim
        claim.settle()
    except BaseException:
        claim.settle()
        raise
    finally:
        lock.release()
        if not (claim.workshop / LIST).exists():
            shutil.rmtree(claim.workshop, ignore_errors=True)
        with suppress(OSError):  # at the first that has something in it
            for folder in made:
                folder.rmdir()


@contextmanager
def output_folder(
    directory: Path, what: str, is_one: Callable[[Path], bool], force: bool
) -> Iterator[Claim]:
    """Claim the --out folder of `what` is about to be made, such as "run", before any work is done.

    It must be new, empty, or hold an earlier one, as `is_one` tells, and then `force` is needed.
    Raises InputError for a place that must not or cannot be written to.
    """
    place = f"--out {directory}"
    refuse_inside_scenario(directory, place)

    def check(target: Path) -> None:
        if not target.exists() or not {path.name for path in target.iterdir()} - {WORKSHOP}:
            return
        if not is_one(target):
            allowed = f"should be new, empty, or an earlier {what}'s"
            raise InputError([Fault(place, "a folder with other things in it", allowed)])
        if not force:
            raise InputError([Fault(place, f"an earlier {what}", "add --force to replace it")])

    target = resolved(directory, place)
    if not (target / WORKSHOP).exists():
        check(target)  # before anything is made there
    with claimed(directory, place) as claim:
        check(target)  # what was interrupted is whole again
        yield claim


def resolved(directory: Path, place: str) -> Path:
    """Where a folder really lies, through all links; raises InputError if it can be none."""
    try:
        target = directory.resolve()
        if target.exists() and not target.is_dir():
            raise InputError([Fault(place, "a file", "should be a folder")])
    except (OSError, RuntimeError) as error:  # RuntimeError: links that lead round in a circle
        raise unwritable(place, error) from error
    return target


def refuse_inside_scenario(path: Path, place: str) -> None:
    """Nothing is written into a scenario's folder: with other files in it, it cannot be read."""
    for folder in resolved_parents(path):
        if (folder / SETTINGS).is_file():
            found = f"a place inside the scenario folder {folder}"
            allowed = "should be outside: a scenario folder holds the scenario's files only"
            raise InputError([Fault(place, found, allowed)])


def resolved_parents(path: Path) -> tuple[Path, ...]:
    """A place and all folders above it, through all links; none where it cannot be followed."""
    try:
        return (path.resolve(), *path.resolve().parents)
    except (OSError, RuntimeError):
        return ()


def put_files(contents: Mapping[Path, bytes]) -> None:
    """Write single files, each whole or not at all; links are followed.

    All are written beside their places first, so that where one cannot be, none is.
    """
    fresh: list[tuple[Path, Path]] = []
    try:
        for path, content in contents.items():
            target = path.resolve()
            beside = target.with_name(f".{target.name}.{os.getpid()}.new")
            target.parent.mkdir(parents=True, exist_ok=True)
            fresh.append((beside, target))
            beside.write_bytes(content)
        for beside, target in fresh:
            os.replace(beside, target)
    except (OSError, RuntimeError) as error:
        raise unwritable(", ".join(str(path) for path in contents), error) from error
    finally:
        for beside, _ in fresh:
            beside.unlink(missing_ok=True)


def unwritable(place: str, error: Exception) -> InputError:
    """What to say of a place that cannot be written."""
    return InputError([Fault(place, f"a place that cannot be written ({error})", "writable")])


def _write(path: Path, content: str | bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(content.encode() if isinstance(content, str) else content)


def _move(path: Path, to: Path) -> None:
    to.parent.mkdir(parents=True, exist_ok=True)
    os.replace(path, to)
