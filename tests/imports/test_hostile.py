"""Unreadable, hostile and enormous files: refused in words, in bounded memory."""

import io
import tracemalloc
from collections.abc import Callable

import pytest
import xlsxwriter

from evdash.errors import InputError
from evdash.files.draft import RECORDS as SCENARIO_TABLES
from evdash.files.draft import read_rows
from evdash.imports.pandapower_json import read_net
from evdash.imports.scenario_book import read_book
from evdash.imports.tables import read_foreign
from evdash.imports.workbook import read_sheets
from tests.imports.hostile import RECORDS, TABLES, USUAL, WORKBOOKS, with_parts

MOST_BYTES = 400 * 1024 * 1024
"""What reading a file of the size the app takes may need beside the file itself."""


def refused(read: Callable[[], object]) -> str:
    """What is said of a file; nothing but InputError may come of it, and little memory go."""
    tracemalloc.start()
    try:
        with pytest.raises(InputError) as error:
            read()
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert peak < MOST_BYTES, f"{peak / 2**20:.0f} MiB"
    assert len(error.value.faults) <= 200
    return str(error.value)


@pytest.mark.parametrize("kind", WORKBOOKS)
def test_hostile_workbooks_are_refused_in_words(kind: str) -> None:
    make, words = WORKBOOKS[kind]
    content = make()
    told = refused(lambda: read_foreign("mine.xlsx", content))
    assert told.startswith("mine.xlsx")
    assert words in told
    if words == "cannot be read":
        assert words in refused(lambda: read_book("mine.xlsx", content))


@pytest.mark.parametrize("kind", TABLES)
def test_hostile_tables_are_refused_in_words(kind: str) -> None:
    make, words = TABLES[kind]
    content = make()
    assert words in refused(lambda: read_foreign("mine.csv", content))


@pytest.mark.parametrize("kind", TABLES)
@pytest.mark.parametrize("file", ["nodes.csv", "arrivals.csv"])
def test_hostile_tables_of_a_scenario_are_refused_in_words(kind: str, file: str) -> None:
    content = TABLES[kind][0]()
    header = ",".join(SCENARIO_TABLES[file].model_fields).encode()
    for text in (content, header + b"\n" + content):
        tracemalloc.start()
        _, faults = read_rows(file, text)
        peak = tracemalloc.get_traced_memory()[1]
        tracemalloc.stop()
        assert faults
        assert peak < MOST_BYTES


@pytest.mark.parametrize("kind", RECORDS)
def test_hostile_json_is_refused_in_words(kind: str) -> None:
    make, words = RECORDS[kind]
    content = make()
    assert words in refused(lambda: read_foreign("mine.json", content))
    refused(lambda: read_net("mine.json", content))


def test_what_is_too_large_is_told_by_its_size() -> None:
    content = b"a,b\n" * (9 * 2**20)
    assert "36.0 MiB; at most 32 MiB" in refused(lambda: read_foreign("mine.csv", content))
    assert "36.0 MiB; at most 32 MiB" in refused(lambda: read_net("mine.json", content))


def test_formulas_count_by_their_value_and_links_elsewhere_are_not_followed() -> None:
    target = io.BytesIO()
    with xlsxwriter.Workbook(target, {"in_memory": True}) as book:
        page = book.add_worksheet("arrivals")
        page.write_row(0, 0, ["arrival", "energy_kwh"])
        page.write_string(1, 0, "2024-05-06 08:00")
        page.write_formula(1, 1, "='[other.xlsx]Sheet1'!A1*2", None, 7.5)
        page.write_string(2, 0, "=HYPERLINK(x)")
        page.write_url(2, 1, "https://example.org/", string="9")
    table = read_foreign("mine.xlsx", target.getvalue())
    assert [row["energy_kwh"] for row in table.rows] == ["7.5", "9"]
    assert table.rows[1]["arrival"] == "=HYPERLINK(x)"
    linked = with_parts({"xl/externalLinks/externalLink1.xml": "<no, xml"})
    assert list(read_sheets("mine.xlsx", linked)) == list(USUAL)
