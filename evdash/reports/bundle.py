"""Where the files of a day that is handed on may be written."""

import os
from collections.abc import Mapping
from pathlib import Path

from evdash.errors import Fault, InputError
from evdash.files.exchange import refuse_inside_scenario


def check_files(targets: Mapping[str, Path], force: bool) -> None:
    """Refuse files, by option, that lie there already or cannot be written, before any work."""
    faults: list[Fault] = []
    for option, path in targets.items():
        place = f"{option} {path}"
        try:
            refuse_inside_scenario(path.parent, place)
        except InputError as error:
            faults += error.faults
        if path.is_dir():
            faults.append(Fault(place, "a folder", "should be a file"))
        elif path.exists() and not force:
            faults.append(Fault(place, "a file", "add --force to replace it"))
        elif not path.absolute().parent.is_dir():
            faults.append(Fault(place, f"no folder {path.parent}", "should be in one"))
        elif not os.access(path.resolve().parent, os.W_OK):
            faults.append(Fault(place, "a folder that cannot be written to", "should be writable"))
    if len({path.absolute() for path in targets.values()}) < len(targets):
        named = ", ".join(str(path) for path in targets.values())
        faults.append(Fault(" ".join(targets), named, "should be different files"))
    if faults:
        raise InputError(faults)
