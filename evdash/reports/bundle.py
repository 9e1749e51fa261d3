"""Files as they are handed on: written all together or not at all."""

import tempfile
from collections.abc import Mapping
from pathlib import Path

from evdash.errors import Fault, InputError


def check_files(targets: Mapping[str, Path], force: bool) -> None:
    """Refuse files, by option, that lie there already or cannot be written, before any work."""
    faults = []
    for option, path in targets.items():
        place = f"{option} {path}"
        if path.is_dir():
            faults.append(Fault(place, "a folder", "should be a file"))
        elif path.exists() and not force:
            faults.append(Fault(place, "a file", "add --force to replace it"))
        elif not path.absolute().parent.is_dir():
            faults.append(Fault(place, f"no folder {path.parent}", "should be in one"))
    if len({path.absolute() for path in targets.values()}) < len(targets):
        named = ", ".join(str(path) for path in targets.values())
        faults.append(Fault(" ".join(targets), named, "should be different files"))
    if faults:
        raise InputError(faults)


def write_files(contents: Mapping[Path, bytes]) -> None:
    """Write files; all are written beside their places first, so that none is left half done."""
    try:
        with tempfile.TemporaryDirectory(dir=next(iter(contents)).absolute().parent) as scratch:
            fresh = []
            for number, (path, content) in enumerate(contents.items()):
                beside = Path(scratch) / str(number)
                beside.write_bytes(content)
                fresh.append((beside, path))
            for beside, path in fresh:
                _put(beside, path)
    except OSError as error:
        place = ", ".join(str(path) for path in contents)
        fault = Fault(place, f"a place that cannot be written ({error})", "writable")
        raise InputError([fault]) from error


def _put(beside: Path, path: Path) -> None:
    try:
        beside.replace(path)
    except OSError:  # on another disk
        path.write_bytes(beside.read_bytes())
