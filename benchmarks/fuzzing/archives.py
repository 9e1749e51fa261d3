"""Zip files no honest program writes: bombs, paths that escape, links, doubles, damage."""

import io
import struct
import warnings
import zipfile
from collections.abc import Callable

import numpy as np

from benchmarks.fuzzing.folders import BASES, Files, base, spoilt_folder
from benchmarks.fuzzing.values import hostile_text, pick

ESCAPES = ("../nodes.csv", "/etc/passwd", "a/../../nodes.csv", "C:\\nodes.csv", "..\\nodes.csv")
BOMB_BYTES = 80 * 2**20
SYMLINK = 0o120777 << 16


def spoilt_zip(rng: np.random.Generator) -> bytes:
    """A zip of a scenario that is right or spoilt, with something wrong about the zip itself."""
    files = spoilt_folder(rng) if rng.random() < 0.4 else dict(base(int(rng.integers(0, BASES))))
    return bytes(pick(rng, CHANGES)(rng, files))


def plain(
    files: Files, top: str = "", method: int = zipfile.ZIP_DEFLATED, more: Files | None = None
) -> bytes:
    """Files zipped, under a top folder or none; `more` may repeat names."""
    target = io.BytesIO()
    with warnings.catch_warnings(), zipfile.ZipFile(target, "w", method) as archive:
        warnings.simplefilter("ignore")  # names twice are meant
        for name, content in [*files.items(), *(more or {}).items()]:
            archive.writestr(_entry(f"{top}{name}", method), content)
    return target.getvalue()


def _entry(name: str, method: int = zipfile.ZIP_STORED) -> zipfile.ZipInfo:
    """An entry that bears no time of its own, so that the same files give the same bytes."""
    entry = zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0))
    entry.compress_type = method
    return entry


def _as_it_is(rng: np.random.Generator, files: Files) -> bytes:
    tops = ("", "scenario/", "a b/", "é/", "./", "a/b/", "__MACOSX/", "a" * 200 + "/")
    methods = (zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA)
    return plain(files, pick(rng, tops), pick(rng, methods))


def _escape(rng: np.random.Generator, files: Files) -> bytes:
    return plain(files, pick(rng, ("", "a/")), more={pick(rng, ESCAPES): b"x"})


def _twice(rng: np.random.Generator, files: Files) -> bytes:
    name = pick(rng, sorted(files) or ["nodes.csv"])
    return plain(files, more={name: files.get(name, b"")})


def _odd_name(rng: np.random.Generator, files: Files) -> bytes:
    name = hostile_text(rng).replace("\x00", "") or "x"
    return plain(files, more={name[:60000]: b"1"})


def _link(rng: np.random.Generator, files: Files) -> bytes:
    """An entry that says it is a symbolic link."""
    target = io.BytesIO()
    name = pick(rng, sorted(files) or ["nodes.csv"])
    with zipfile.ZipFile(target, "w") as archive:
        for other, content in files.items():
            if other != name:
                archive.writestr(_entry(other), content)
        entry = _entry(name)
        entry.create_system = 3
        entry.external_attr = SYMLINK
        archive.writestr(entry, pick(rng, (b"/etc/passwd", b"../../secret", files.get(name, b""))))
    return target.getvalue()


def _bomb(rng: np.random.Generator, files: Files) -> bytes:
    """Far more inside than outside, in one file, in many, or said to be small."""
    how = pick(rng, ("large", "lying", "many", "nested"))
    name = pick(rng, ("nodes.csv", "lines.csv", "scenario.toml"))
    if how == "many":
        return plain(files, more={f"f{k}.csv": b"" for k in range(int(rng.integers(51, 3000)))})
    if how == "nested":
        return plain({**files, "inner.zip": plain(files)})
    content = bytes(plain({**files, name: b"0" * BOMB_BYTES}))
    if how == "large":
        return content
    honest, lie = struct.pack("<L", BOMB_BYTES), struct.pack("<L", int(rng.integers(0, 1000)))
    return content.replace(honest, lie)


def _encrypted(rng: np.random.Generator, files: Files) -> bytes:
    """Entries flagged as encrypted, or packed by a method nobody knows."""
    content = bytearray(plain(files))
    offset, value = pick(rng, ((6, 1), (8, 99), (8, 9), (7, 8), (4, 255)))
    for mark, shift in ((b"PK\x03\x04", 0), (b"PK\x01\x02", 2)):
        place = content.find(mark)
        while place >= 0:
            content[place + offset + shift] = value
            place = content.find(mark, place + 4)
    return bytes(content)


def _damaged(rng: np.random.Generator, files: Files) -> bytes:
    """Bytes exchanged, cut off, put before or doubled."""
    content = bytearray(plain(files))
    how = pick(rng, ("bytes", "bytes", "bytes", "cut", "before", "twice", "directory"))
    if how == "bytes":
        for _ in range(int(rng.integers(1, 20))):
            content[int(rng.integers(0, len(content)))] = int(rng.integers(0, 256))
    elif how == "cut":
        del content[int(rng.integers(0, len(content))) :]
    elif how == "before":
        return rng.bytes(int(rng.integers(1, 100))) + bytes(content)
    elif how == "twice":
        return bytes(content) * 2
    else:  # the central directory alone, where sizes and offsets stand
        place = content.find(b"PK\x01\x02")
        for _ in range(int(rng.integers(1, 6))):
            content[int(rng.integers(place, len(content)))] = int(rng.integers(0, 256))
    return bytes(content)


def _no_zip(rng: np.random.Generator, files: Files) -> bytes:
    return bytes(
        pick(rng, (b"", b"PK", b"PK\x05\x06" + b"\0" * 18, rng.bytes(200), b"\x1f\x8b\x08" * 9))
    )


CHANGES: tuple[Callable[[np.random.Generator, Files], bytes], ...] = (
    *(_as_it_is, _escape, _twice, _odd_name, _link, _bomb, _encrypted, _damaged, _damaged),
    _no_zip,
)
