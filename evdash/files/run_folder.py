"""A run's folder: written as a whole or not at all, and read back for the audit."""

import hashlib
import json
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from evdash.errors import Fault, InputError

SUMMARY = "summary.json"
SCENARIO = "scenario"
RUN_FORMAT = "evdash run 1"


def scenario_hash(files: Mapping[str, bytes]) -> str:
    """SHA-256 over the names and contents of a resolved scenario's files, README.md apart."""
    digest = hashlib.sha256()
    for name in sorted(set(files) - {"README.md"}):
        digest.update(f"{name}\n{len(files[name])}\n".encode())
        digest.update(files[name])
    return digest.hexdigest()


def check_target(directory: Path, force: bool) -> None:
    """Refuse a place that must not be written to, before any work is done."""
    place = f"--out {directory}"
    if not directory.exists():
        return
    if not directory.is_dir():
        raise InputError([Fault(place, "a file", "should be a folder")])
    if not any(directory.iterdir()):
        return
    if not _is_run(directory):
        allowed = "should be new, empty, or an earlier run's"
        raise InputError([Fault(place, "a folder with other things in it", allowed)])
    if not force:
        raise InputError([Fault(place, "an earlier run", "add --force to replace it")])


def _is_run(directory: Path) -> bool:
    try:
        summary = json.loads((directory / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(summary, dict) and summary.get("format") == RUN_FORMAT


def write_run(directory: Path, files: Mapping[str, str]) -> None:
    """Write a run's files, paths relative to `directory`; an earlier run there is replaced.

    Everything is written beside the target first, so that a failure leaves no half run.
    """
    try:
        directory.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=directory.parent, prefix=".evdash-") as scratch:
            fresh = Path(scratch) / "run"
            for name, text in files.items():
                path = fresh / name
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(text, encoding="utf-8", newline="")
            if directory.exists():
                _take_away(directory, Path(scratch) / "earlier")
            if directory.exists():
                shutil.copytree(fresh, directory, dirs_exist_ok=True)
            else:
                fresh.rename(directory)
    except OSError as error:
        fault = Fault(f"--out {directory}", f"a place that cannot be written ({error})", "writable")
        raise InputError([fault]) from error


def _take_away(directory: Path, to: Path) -> None:
    """Move an earlier run's own files out; what else lies there stays."""
    to.mkdir()
    for path in list(directory.iterdir()):
        if path.name == SCENARIO or path.suffix in (".csv", ".json"):
            path.rename(to / path.name)
    if not any(directory.iterdir()):
        directory.rmdir()


def read_run(directory: Path) -> tuple[dict[str, bytes], dict[str, object]]:
    """A run folder's tables and its summary; raises InputError if it is not one."""
    allowed = "should be a folder written by `evdash run --out`"
    if not directory.is_dir():
        raise InputError([Fault(str(directory), "no such folder", allowed)])
    try:
        summary = json.loads((directory / SUMMARY).read_text(encoding="utf-8"))
        files = {p.name: p.read_bytes() for p in directory.iterdir() if p.suffix == ".csv"}
    except (OSError, ValueError, RecursionError) as error:
        found = f"a {SUMMARY} that cannot be read ({error})"
        raise InputError([Fault(str(directory), found, allowed)]) from error
    if not isinstance(summary, dict) or summary.get("format") != RUN_FORMAT:
        raise InputError([Fault(f"{directory}/{SUMMARY}", "another format", allowed)])
    return files, summary
