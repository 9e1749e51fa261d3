"""A scenario's files as bytes, whether they lie in a folder or in a .zip of one."""

import lzma
import struct
import zipfile
import zlib
from collections import Counter
from pathlib import Path, PurePosixPath
from typing import IO

from evdash.errors import Fault, InputError

WORKSHOP = ".evdash-writing"
"""Our own folder inside one that is written to, there only meanwhile: evdash/files/exchange.py."""
MAX_BYTES = 64 * 1024 * 1024
MAX_FILES = 50
RULE = "should be a scenario folder or a .zip of one"
UNZIPPABLE = (
    zipfile.BadZipFile,
    NotImplementedError,  # a compression this Python does not know
    RuntimeError,  # encrypted
    EOFError,
    ValueError,
    struct.error,
    zlib.error,
    lzma.LZMAError,
)


def read_files(path: Path | str) -> dict[str, bytes]:
    """File names and contents of a scenario folder or .zip; nothing is written or unpacked."""
    path = Path(path)
    try:
        if path.is_dir():
            return _read_directory(path)
        if path.is_file():
            with path.open("rb") as file:
                return read_zip(file, path.name)
    except OSError as error:
        found = f"something unreadable ({error.strerror or error})"
        raise InputError([Fault(str(path), found, RULE)]) from error
    raise InputError([Fault(str(path), "nothing there", RULE)])


def _read_directory(path: Path) -> dict[str, bytes]:
    files: dict[str, bytes] = {}
    total = 0
    for entry in sorted(path.iterdir()):
        if entry.name == WORKSHOP:
            found = "what an interrupted import left"
            allowed = "repeat the import: it puts the folder right first"
            raise InputError([Fault(str(entry), found, allowed)])
        if not entry.is_file():
            found = "a folder" if entry.is_dir() else "something that is not a file"
            raise InputError([Fault(str(entry), found, "a scenario folder holds files only")])
        total += entry.stat().st_size
        _refuse_too_large(str(path), len(files) + 1, total)
        files[entry.name] = entry.read_bytes()
    return files


def read_zip(file: IO[bytes], name: str) -> dict[str, bytes]:
    """The files of a zipped scenario; one single top folder is looked through."""
    try:
        with zipfile.ZipFile(file) as archive:
            entries = [entry for entry in archive.infolist() if not entry.is_dir()]
            _refuse_too_large(name, len(entries), sum(entry.file_size for entry in entries))
            _refuse_repeated(name, [entry.filename for entry in entries])
            # no more is unpacked of an entry than the size it was counted with
            contents = {entry.filename: archive.read(entry) for entry in entries}
    except UNZIPPABLE as error:
        fault = Fault(name, f"a file that cannot be unzipped ({error})", "a .zip of a folder")
        raise InputError([fault]) from error
    return _without_top_folder(name, contents)


def _refuse_repeated(name: str, entries: list[str]) -> None:
    repeated = [entry for entry, count in Counter(entries).items() if count > 1]
    if repeated:
        raise InputError([Fault(name, f"{repeated[0]!r} more than once", "each file once")])


def _without_top_folder(name: str, contents: dict[str, bytes]) -> dict[str, bytes]:
    parts = {file: PurePosixPath(file).parts for file in contents}
    tops = {part[0] for part in parts.values() if len(part) > 1 and part[0] not in ("..", "/")}
    depth = 1 if len(tops) == 1 and all(len(part) > 1 for part in parts.values()) else 0
    deep = sorted(file for file, part in parts.items() if len(part) != depth + 1)
    if deep:
        raise InputError(
            [Fault(name, f"{deep[0]!r}", "files at the top or in one single top folder")]
        )
    return {part[depth]: contents[file] for file, part in parts.items()}


def _refuse_too_large(name: str, count: int, size: int) -> None:
    if count > MAX_FILES or size > MAX_BYTES:
        raise InputError(
            [
                Fault(
                    name,
                    f"{count} files of {size / 2**20:.0f} MiB in all",
                    f"at most {MAX_FILES} files and {MAX_BYTES // 2**20} MiB",
                )
            ]
        )
