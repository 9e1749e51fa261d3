"""Folders and zips: what may be read, and that nothing else is."""

import io
import os
import struct
import zipfile

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.domain.scenario import Scenario
from evdash.errors import InputError
from evdash.files import folder
from evdash.files.bundled import PRESETS
from evdash.files.folder import read_files, read_zip
from evdash.files.scenario_folder import parse_scenario, read_scenario
from tests.files.spoiling import files_of, generated_scenario, recorded_scenario

FILES = files_of(recorded_scenario())


def zipped(files, top="", **options) -> bytes:
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w", **options) as archive:
        for name, text in files.items():
            archive.writestr(top + name, text)
    return content.getvalue()


def refusal(content: bytes) -> str:
    with pytest.raises(InputError) as caught:
        read_zip(io.BytesIO(content), "day.zip")
    (fault,) = caught.value.faults
    assert fault.place == "day.zip"
    return str(fault)


@pytest.mark.parametrize("top", ["", "day/"])
@pytest.mark.parametrize("compression", [zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED])
def test_zip_of_the_files_or_of_their_folder(tmp_path, top, compression):
    path = tmp_path / "day.zip"
    path.write_bytes(zipped(FILES, top, compression=compression))
    assert read_scenario(path) == recorded_scenario()
    assert os.listdir(tmp_path) == ["day.zip"]


def test_folder(tmp_path):
    for name, content in FILES.items():
        (tmp_path / name).write_bytes(content)
    assert read_scenario(tmp_path) == recorded_scenario()
    (tmp_path / "sub").mkdir()
    with pytest.raises(InputError, match="a folder; a scenario folder holds files only"):
        read_files(tmp_path)


@pytest.mark.parametrize(
    "names",
    [
        ("../nodes.csv",),
        ("/nodes.csv",),
        ("a/b/nodes.csv",),
        ("a/nodes.csv", "b/lines.csv"),
        ("a/nodes.csv", "lines.csv"),
        ("a/../../nodes.csv",),
    ],
)
def test_zip_with_other_than_one_top_folder(names):
    assert "files at the top or in one single top folder" in refusal(
        zipped(dict.fromkeys(names, ""))
    )


def test_zip_with_a_file_twice():
    twice = zipped({"nodes.csv": "a", "nodes.txt": "b"}).replace(b"nodes.txt", b"nodes.csv")
    assert "'nodes.csv' more than once" in refusal(twice)


def test_zip_too_large_is_refused_by_what_it_says_it_holds(monkeypatch):
    monkeypatch.setattr(folder, "MAX_BYTES", 10_000)
    bomb = zipped({"nodes.csv": b"0" * 1_000_000}, compression=zipfile.ZIP_DEFLATED)
    assert len(bomb) < 10_000
    assert "1 files of 1 MiB in all" in refusal(bomb)


def test_zip_that_lies_about_its_size_unpacks_no_more_than_it_says():
    bomb = zipped({"nodes.csv": b"0" * 1_000_000}, compression=zipfile.ZIP_DEFLATED)
    true, told = struct.pack("<L", 1_000_000), struct.pack("<L", 100)
    assert bomb.count(true) == 2
    assert "cannot be unzipped" in refusal(bomb.replace(true, told))


def test_zip_of_too_many_files():
    assert "51 files" in refusal(zipped({f"{n}.csv": "" for n in range(51)}))


def test_encrypted_zip():
    plain = bytearray(zipped({"nodes.csv": "node"}))
    for header, flags in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        plain[plain.index(header) + flags] |= 1
    assert "cannot be unzipped" in refusal(bytes(plain))
    assert "encrypted" in refusal(bytes(plain))


@pytest.mark.parametrize("content", [b"", b"PK", b"no zip at all", b"\0" * 1000])
def test_file_that_is_no_zip(content):
    assert "cannot be unzipped" in refusal(content)


@pytest.mark.parametrize("keep", [0.1, 0.5, 0.9, 0.99])
def test_truncated_zip(keep):
    whole = zipped(FILES, compression=zipfile.ZIP_DEFLATED)
    assert "cannot be unzipped" in refusal(whole[: int(keep * len(whole))])


@given(data=st.data(), compression=st.sampled_from([zipfile.ZIP_DEFLATED, zipfile.ZIP_LZMA]))
def test_damaged_zip_gives_its_scenario_or_a_fault(data, compression):
    content = bytearray(zipped(files_of(generated_scenario()), compression=compression))
    for _ in range(data.draw(st.integers(1, 4))):
        content[data.draw(st.integers(0, len(content) - 1))] = data.draw(st.integers(0, 255))
    try:
        scenario = parse_scenario(read_zip(io.BytesIO(bytes(content)), "day.zip"))
    except InputError:
        return
    assert isinstance(scenario, Scenario)


def test_nothing_there_and_things_that_cannot_be_read(tmp_path):
    (tmp_path / "broken").symlink_to(tmp_path / "nowhere")
    os.mkfifo(tmp_path / "pipe")
    for path, told in (
        (tmp_path / "none", "nothing there"),
        (tmp_path / "broken", "nothing there"),
        (tmp_path / "pipe", "nothing there"),
        (tmp_path / ("x" * 5000), "something unreadable"),
        (tmp_path, "something that is not a file"),
    ):
        with pytest.raises(InputError, match=told):
            read_files(path)


def test_a_folder_may_be_given_as_text() -> None:
    place = PRESETS / "summer-weekday"
    assert read_scenario(f"{place}") == read_scenario(place)
    with pytest.raises(InputError, match="nothing there"):
        read_scenario("folder")
