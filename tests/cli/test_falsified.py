"""Every column of every file of a run and every key of its summary falsified, once each way.

A falsification that the audit lets pass is a fault, unless the audit itself declares that it takes
that column or key on trust (`evdash/audit/coverage.py`).
"""

import csv
import io
import json
import math
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest

from evdash.audit import audit as auditing
from evdash.audit.audit import audit_run
from evdash.audit.coverage import COVERAGE, SUMMARY_KEYS, standing_of
from evdash.audit.objective import SOLVES_P1
from evdash.errors import InputError
from evdash.files.explanation_rows import EXPLANATION_TABLES
from evdash.files.run_tables import RUN_TABLES
from evdash.policies.registry import RULES
from tests.cli.falsified_runs import LOST, RUNS, run_of

TABLES = {**RUN_TABLES, **EXPLANATION_TABLES}
Cells = list[dict[str, str]]
HELD_ALIKE = {
    ("vehicles.csv", "reason"): {"another's", "swapped", "figures"},
    ("ledger.csv", "since_interval"): {"another's", "swapped"},
    ("ledger.csv", "cause"): {"another's", "swapped"},
    ("binding.csv", "reached"): set(),
    ("summary.json", "policy"): {"another's"},
}
"""Of what is held, not worked out: the falsifications that another row's or name's value makes."""


@pytest.fixture(scope="module", params=[*RUNS, LOST])
def run(request, tmp_path_factory) -> Path:
    return run_of(request.param, tmp_path_factory.mktemp("falsified"))


@pytest.fixture(scope="module", autouse=True)
def one_flow_for_all():
    """The same power flow is asked for by every audit of a run: solved once here."""
    solved, patch = {}, pytest.MonkeyPatch()
    flow = auditing.ac_flow

    def once(scenario, station_kw):
        feeder = (
            scenario.feeder,
            scenario.station,
            scenario.nodes,
            scenario.lines,
            scenario.profile,
        )
        if solved.get("feeder") != feeder:
            solved.clear()
            solved["feeder"] = feeder
        key = station_kw.tobytes()
        if key not in solved:
            solved[key] = flow(scenario, station_kw)
        return solved[key]

    patch.setattr(auditing, "ac_flow", once)
    yield
    patch.undo()


class Tampered:
    """A copy of a run in which one file at a time is another, and what the audit then finds."""

    def __init__(self, run: Path, place: Path) -> None:
        self.folder = Path(shutil.copytree(run, place / "copy"))
        self.sound = set(audit_run(self.folder).findings)

    def passes(self, file: str, text: str) -> bool:
        """Whether the audit has nothing new to say, and can read it."""
        path = self.folder / file
        before = path.read_bytes()
        path.write_text(text, encoding="utf-8", newline="")
        try:
            return set(audit_run(self.folder).findings) <= self.sound
        except InputError:
            return False
        finally:
            path.write_bytes(before)


@pytest.fixture
def tampered(run, tmp_path) -> Tampered:
    return Tampered(run, tmp_path)


def table_text(header: list[str], rows: Cells) -> str:
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, header, extrasaction="ignore")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def other_cells(cell: str, others: list[str]) -> Iterator[tuple[str, str]]:
    """Kinds of falsification of a cell, and what then stands in it."""
    yield "blanked", ""
    another = next((other for other in others if other not in (cell, "")), None)
    if another is not None:
        yield "another's", another
    try:
        value = float(cell)
    except ValueError:
        yield "text", f"x{cell}"
        if ": " in cell:
            yield "figures", f"{cell}x"
        if not cell:
            yield "more", "1"
        return
    whole = "." not in cell and "e" not in cell
    yield "more", str(int(value) + 1) if whole else repr(value + 0.05 * abs(value) + 0.5)
    if value > 0 or not whole:
        yield "less", str(int(value) - 1) if whole else repr(value - 0.1 * abs(value) - 0.2)


def rows_that_matter(rows: Cells, column: str) -> Iterator[int]:
    """Of the rows with a value the first and the one in the middle; of those without, and of those
    with nought, the first."""
    kinds: dict[str, list[int]] = {}
    for number, row in enumerate(rows):
        kind = row[column] if row[column] in ("", "0", "0.0") else "value"
        kinds.setdefault(kind, []).append(number)
    for kind, numbers in kinds.items():
        yield from {numbers[0], numbers[len(numbers) // 2 if kind == "value" else 0]}


def falsified_cells(header: list[str], rows: Cells) -> Iterator[tuple[str, str, str]]:
    """Column, kind and text of every falsification of a table's cells, and of whole columns."""
    for column in header:
        yield column, "column removed", table_text([c for c in header if c != column], rows)
        told = [row[column] for row in rows]
        for number in rows_that_matter(rows, column):
            others = (n for n in range(number + 1, len(rows)) if not alike(told[n], told[number]))
            changes = [(kind, {number: cell}) for kind, cell in other_cells(told[number], told)]
            for other in [*others][:1]:
                changes.append(("swapped", {number: told[other], other: told[number]}))
            for kind, cells in changes:
                changed = [{**row, column: cells.get(n, row[column])} for n, row in enumerate(rows)]
                if is_untrue(rows, changed, column, number):
                    told_kind = f"row {number + 2} {kind}: {cells[number]}"
                    yield column, told_kind, table_text(header, changed)


def is_untrue(rows: Cells, changed: Cells, column: str, number: int) -> bool:
    """Whether a changed table says another thing than before, to within what the audit tells."""
    before, after = rows[number][column], changed[number][column]
    if alike(before, after) or sorted(map(cells_of, rows)) == sorted(map(cells_of, changed)):
        return False
    # of the limits a feeder is beyond by itself, any may be told to bind
    return not (column == "binding" and rows[number]["headroom_kw"] == "0.0" and after)


def cells_of(row: dict[str, str]) -> tuple[str, ...]:
    """A row's cells, numbers to as many digits as the audit tells apart."""
    return tuple(f"{float(cell):.5f}" if is_number(cell) else cell for cell in row.values())


def is_number(cell: str) -> bool:
    try:
        return math.isfinite(float(cell))
    except ValueError:
        return False


def alike(cell: str, other: str) -> bool:
    """Whether two cells say the same, to within what the audit tells apart."""
    if is_number(cell) and is_number(other):
        return abs(float(cell) - float(other)) <= 2e-6
    return cell == other


def falsified_rows(header: list[str], rows: Cells) -> Iterator[tuple[str, str]]:
    for number in {0, len(rows) // 2, len(rows) - 1}:
        yield f"row {number + 2} removed", table_text(header, rows[:number] + rows[number + 1 :])
        yield f"row {number + 2} twice", table_text(header, [*rows, rows[number]])
    yield "all rows removed", table_text(header, [])


def may_pass(file: str, column: str, kind: str) -> bool:
    standing = standing_of(file, column)
    if standing == "on trust":
        return kind not in ("removed", "column removed")
    if standing == "held":
        return any(alike in kind for alike in HELD_ALIKE.get((file, column), ()))
    return False


def test_no_column_of_any_table_is_falsified_unseen(tampered):
    unseen = []
    for file in TABLES:
        if not (tampered.folder / file).exists():
            continue
        with (tampered.folder / file).open(newline="", encoding="utf-8") as text:
            reader = csv.DictReader(text)
            rows, header = list(reader), list(reader.fieldnames or ())
        if not rows:
            continue
        unseen += [
            f"{file}, {column}: {kind}"
            for column, kind, text in falsified_cells(header, rows)
            if not may_pass(file, column, kind) and tampered.passes(file, text)
        ]
        if any(entry.file == file and entry.standing != "on trust" for entry in COVERAGE):
            unseen += [
                f"{file}: {kind}"
                for kind, text in falsified_rows(header, rows)
                if tampered.passes(file, text)
            ]
    assert not unseen, "\n".join(unseen)


def other_values(value: object) -> Iterator[tuple[str, object]]:
    """Kinds of falsification of a value of JSON, nested ones included."""
    if value is not None:
        yield "blanked", None
    if isinstance(value, dict):
        for key, inner in value.items():
            yield f"{key} removed", {k: v for k, v in value.items() if k != key}
            yield from ((f"{key} {kind}", {**value, key: v}) for kind, v in other_values(inner))
        yield "key added", {**value, "new": 1}
    elif isinstance(value, list):
        yield "entry added", [*value, value[-1] if value else 1]
        for n, inner in enumerate(value[:2]):
            yield f"entry {n} removed", value[:n] + value[n + 1 :]
            for kind, v in other_values(inner):
                yield f"entry {n} {kind}", [*value[:n], v, *value[n + 1 :]]
    elif isinstance(value, int) and not isinstance(value, bool):
        yield from (("more", value + 1), ("less", value - 1), ("text", str(value)))
    elif isinstance(value, float):
        yield from (("more", 1.05 * value + 0.01), ("less", 0.9 * value - 0.01))
    elif isinstance(value, str):
        yield from (("text", f"{value}x"), ("emptied", ""))
    else:
        yield from (("more", 1), ("text", "a"))


def test_no_key_of_the_summary_is_falsified_unseen(tampered):
    summary = json.loads((tampered.folder / "summary.json").read_text(encoding="utf-8"))
    falsified = [("", "key added", {**summary, "new": 1})]
    for key, value in summary.items():
        falsified.append((key, "removed", {k: v for k, v in summary.items() if k != key}))
        falsified += [(key, kind, {**summary, key: v}) for kind, v in other_values(value)]
    policies = [(f"another's: {name}", name) for name in RULES if name != summary["policy"]]
    falsified += [("policy", kind, {**summary, "policy": name}) for kind, name in policies]
    unseen = [
        f"summary.json, {key}: {kind}"
        for key, kind, made in falsified
        if not (key and may_pass("summary.json", key, kind))
        and tampered.passes("summary.json", json.dumps(made))
    ]
    assert not unseen, "\n".join(unseen)


def test_no_file_of_a_run_or_its_scenario_is_left_out_or_changed_unseen(tampered):
    for path in sorted(tampered.folder.rglob("*.*")):
        name = path.relative_to(tampered.folder).as_posix()
        if name in EXPLANATION_TABLES:
            continue  # nothing says that there were any
        text = path.read_bytes()
        path.unlink()
        try:
            with pytest.raises(InputError):
                audit_run(tampered.folder)
        except pytest.fail.Exception:
            assert set(audit_run(tampered.folder).findings) - tampered.sound, name
        finally:
            path.write_bytes(text)


def test_a_policy_is_p1s_if_and_only_if_there_is_an_objective(tampered):
    summary = json.loads((tampered.folder / "summary.json").read_text(encoding="utf-8"))
    for name, solves in SOLVES_P1.items():
        if solves != SOLVES_P1[summary["policy"]]:
            assert not tampered.passes("summary.json", json.dumps({**summary, "policy": name})), (
                name
            )


def test_the_declaration_names_every_column_and_key_once():
    declared = [(entry.file, name) for entry in COVERAGE for name in entry.names]
    columns = [(file, name) for file, record in TABLES.items() for name in record.model_fields]
    keys = [("summary.json", key) for key in SUMMARY_KEYS]
    assert sorted(declared) == sorted([*columns, *keys, ("scenario/", "*")])
    assert set(HELD_ALIKE) <= {
        (entry.file, name) for entry in COVERAGE if entry.standing == "held" for name in entry.names
    }


def test_the_policies_the_audit_knows_are_those_there_are():
    assert list(SOLVES_P1) == list(RULES)
