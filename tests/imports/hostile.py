"""Files made to harm whoever reads them, or only far too large."""

import io
import zipfile
from collections.abc import Callable, Mapping

import openpyxl

from evdash.imports.workbook import written

SHEET = "xl/worksheets/sheet1.xml"
STRINGS = "xl/sharedStrings.xml"
MAIN = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
USUAL = {"arrivals": [["arrival", "energy_kwh"], ["2024-05-06 08:00", 5]]}


def with_parts(parts: Mapping[str, str | bytes]) -> bytes:
    """A workbook with some of its parts exchanged or added."""
    target = io.BytesIO()
    with (
        zipfile.ZipFile(io.BytesIO(written(USUAL))) as source,
        zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive,
    ):
        for entry in source.infolist():
            if entry.filename not in parts:
                archive.writestr(entry.filename, source.read(entry))
        for name, content in parts.items():
            archive.writestr(name, content)
    return target.getvalue()


def sheet(rows: str) -> bytes:
    """A workbook whose only sheet has these rows, as XML."""
    return with_parts({SHEET: f"<worksheet {MAIN}><sheetData>{rows}</sheetData></worksheet>"})


def zipped(name: str, content: str | bytes) -> bytes:
    target = io.BytesIO()
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return target.getvalue()


def lying() -> bytes:
    """A workbook with a part that says it is smaller than it is."""
    size = 30 * 1024 * 1024
    content = with_parts({"xl/media/image.bin": b"\0" * size})
    return content.replace(size.to_bytes(4, "little"), (9).to_bytes(4, "little"))


def uncalculated() -> bytes:
    """A workbook no spreadsheet has ever opened: its formula has no value."""
    book = openpyxl.Workbook()
    page = book.active
    assert page is not None
    page.append(["arrival", "energy_kwh"])
    page.append(["2024-05-06 08:00", "=2+3"])
    target = io.BytesIO()
    book.save(target)
    return target.getvalue()


def entity(name: str, of: str) -> str:
    """An entity ten times as long as another."""
    return f"<!ENTITY {name} '{10 * ('&' + of + ';')}'>"


ENTITIES = (
    '<!DOCTYPE sst [<!ENTITY a "aaaaaaaaaa">'
    + "".join(map(entity, "bcdefghi", "abcdefgh"))
    + f"]><sst {MAIN}><si><t>&i;</t></si></sst>"
)
REACHING_OUT = (
    f'<!DOCTYPE sst [<!ENTITY a SYSTEM "file:///etc/passwd">]><sst {MAIN}><si><t>&a;</t></si></sst>'
)
WORKBOOKS: Mapping[str, tuple[Callable[[], bytes], str]] = {
    "bomb": (lambda: with_parts({"xl/media/a.bin": b"\0" * 80 * 2**20}), "MiB unpacked"),
    "parts": (lambda: with_parts({f"x/{n}": "" for n in range(600)}), "610 parts"),
    "lying": (lying, "cannot be read"),
    "strings": (
        lambda: with_parts({STRINGS: f"<sst {MAIN}>{'<si/>' * 5_000_000}</sst>"}),
        "tags and attributes",
    ),
    "attributes": (
        lambda: sheet("<row" + "".join(f" a{n:x}=''" for n in range(4_100_000)) + "/>"),
        "tags and attributes",
    ),
    "entities": (lambda: with_parts({STRINGS: ENTITIES}), "cannot be read"),
    "reaching out": (lambda: with_parts({STRINGS: REACHING_OUT}), "cannot be read"),
    "rows": (
        lambda: sheet('<row r="95000"/>' + "<row><c><v>1</v></c></row>" * 9_000),
        "at most 100,000 rows",
    ),
    "far row": (lambda: sheet('<row r="1048576"><c><v>1</v></c></row>'), "at most 100,000 rows"),
    "far column": (lambda: sheet('<row><c r="XFD1"><v>1</v></c></row>'), "16,384 columns"),
    "wide": (
        lambda: sheet('<row><c r="GR1"><v>1</v></c></row>' * 10_500),
        "2,000,000 cells in all",
    ),
    "formula": (uncalculated, "row 2, column energy_kwh: found a formula that was never"),
    "text": (lambda: b"arrival,energy_kwh\n2024-05-06 08:00,5\n", "cannot be read"),
    "page": (lambda: b"<html><table><tr><td>1</td></tr></table></html>", "cannot be read"),
    "empty": (lambda: b"", "cannot be read"),
    "old": (lambda: b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1" + b"\0" * 4096, "an old workbook (.xls)"),
    "letter": (lambda: zipped("word/document.xml", "<w/>"), "cannot be read"),
    "archive": (lambda: zipped("[Content_Types].xml", "<Types/>"), "cannot be read"),
    "broken": (lambda: written(USUAL)[:-200], "cannot be read"),
    "no xml": (lambda: with_parts({SHEET: b"\xff\xfe not xml"}), "cannot be read"),
}
"""Workbooks to be refused, and words that say why."""
TABLES: Mapping[str, tuple[Callable[[], bytes], str]] = {
    "lines": (lambda: b"a,b\n" * 2_500_000, "more than 100,000 rows"),
    "blank lines": (lambda: b"a,b\n" + b"\n" * 10_000_000, "more than 100,000 rows"),
    "one row": (lambda: b"," * 10_000_000, "a row of more than 200,000 characters"),
    "row of lines": (lambda: b"a,b\n" + b'"\n",' * 2_000_000, "a row of more than 200,000"),
    "columns": (lambda: ",".join(f"c{n}" for n in range(20_000)).encode(), "20,000 columns"),
    "open quote": (lambda: b'a,b\n"' + b"x\n" * 1_000_000, "no CSV"),
    "picture": (lambda: b"\x89PNG\r\n\x1a\n" + bytes(range(256)), "UTF-8"),
    "utf-16": (lambda: "a,b\n1,2\n".encode("utf-16"), "UTF-8"),
}
RECORDS: Mapping[str, tuple[Callable[[], bytes], str]] = {
    "lists": (lambda: b"[" + b"[]," * 3_000_000 + b"[]]", "lists and objects"),
    "objects": (lambda: b"[" + b"{}," * 3_000_000 + b"{}]", "lists and objects"),
    "numbers": (lambda: b"[" + b"1," * 5_000_000 + b"1]", "values"),
    "deep": (lambda: b"[" * 500_000 + b"]" * 500_000, "not JSON"),
    "long number": (lambda: b'[{"a": ' + b"9" * 1_000_000 + b"}]", "not JSON"),
    "records": (lambda: b"[" + b'{"a":1},' * 150_000 + b'{"a":1}]', "150,001 records"),
    "fields": (
        lambda: b"[{" + b",".join(b'"%d":1' % n for n in range(5_000)) + b"}]",
        "5000 fields",
    ),
    "no json": (lambda: b"%PDF-1.7", "not JSON"),
}
