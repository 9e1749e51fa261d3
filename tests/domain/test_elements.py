"""Elements are read as they are written, and two lines of one name are never taken for one."""

import csv
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import TypeAdapter

from evdash.cli.main import main
from evdash.domain.elements import CHARGERS, Element, ElementKind
from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs
from evdash.domain.words import element_words
from evdash.errors import InputError
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import scenario_files
from evdash.horizon.in_force import in_force
from evdash.horizon.inputs import prepare
from evdash.metrics.verdict import violations
from evdash.reports.account import transformers
from evdash.studies.keys import STUDY_KEYS
from evdash.studies.reading import lay_out, parse_study
from evdash.ui.events.choices import elements
from evdash.ui.studies.ask import _ratings
from tests.builders import line, make_scenario, names, node, vehicle

INPUTS = TypeAdapter(Inputs)
TWINS = Element("line", "s-a", "b"), Element("line", "s", "a-b")
"""Both are called `line:s-a-b`."""


def twins(**fields: object) -> Scenario:
    """The station is at the end of the second of the twins; the rating of each is its own."""
    return make_scenario(
        nodes=[node("s"), node("s-a"), node("a-b"), node("b", load_kw=5, load_kvar=0)],
        lines=[line("s", "s-a"), line("s-a", "b", rating=40), line("s", "a-b", rating=10)],
        station={"node": "a-b"},
        vehicles=[vehicle("v1", need_kwh=12.0), vehicle("v2", need_kwh=12.0)],
        **fields,
    )


@given(
    st.sampled_from(get_args(ElementKind)), st.text("ab:", min_size=1), st.text("a-", min_size=1)
)
def test_what_is_written_is_read(kind: ElementKind, one: str, other: str) -> None:
    element = Element(kind, one, other if kind == "line" else "")
    if kind == "chargers":
        element = CHARGERS
    assert Element.read(str(element)) == element
    if element.is_rating:
        assert Element.read(str(element.export_side)) == element.export_side
        assert element.export_side.import_side == element


@pytest.mark.parametrize("text", ["", "line", "line:", "wire:a-b", "voltage_min:", "chargers:3"])
def test_other_names_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="names no element"):
        Element.read(text)


def test_an_event_names_one_of_two_lines_of_one_name() -> None:
    with pytest.raises(InputError) as wrong:
        twins(events=[{"interval": 1, "event": "rating", "subject": "line:s-a-b", "value": 4}])
    told = str(wrong.value)
    assert "names 2 lines" in told
    assert "line:row 3 (from s-a to b) or line:row 4 (from s to a-b)" in told
    for row, (changed, kept) in ((3, TWINS), (4, TWINS[::-1])):
        event = {"interval": 1, "event": "rating", "subject": f"line:row {row}", "value": 4}
        scenario = twins(events=[event])
        now = in_force(scenario, 1)
        assert now.rating_kva_of(changed) == 4
        assert now.rating_kva_of(kept) == scenario.rating_kva_of(kept)
        assert "(4 kVA)" in element_words(changed, now)
        assert "(4 kVA)" not in element_words(kept, now)


def test_whoever_chooses_among_elements_can_choose_each() -> None:
    scenario = twins()
    assert {scenario.rated_elements[subject] for subject in elements(scenario)} == set(TWINS)
    assert list(transformers(scenario)) == ["row 4", "row 3"]  # the nearer to the station first
    raw = scenario.model_dump()
    with pytest.raises(LookupError, match="2 called 's-a-b'; should be 'row 3' or 'row 4'"):
        STUDY_KEYS["line."].change(raw, "s-a-b.rating_kva", 7.0)
    changed = STUDY_KEYS["line."].change(raw, "row 4.rating_kva", 7.0)["lines"]
    assert [one["rating_kva"] for one in changed] == [None, 40, 7.0]


def test_a_run_on_such_a_feeder_passes_its_audit(tmp_path: Path, capsys) -> None:
    event = {"interval": 1, "event": "rating", "subject": "line:row 4", "value": 4}
    place, out = tmp_path / "scenario", tmp_path / "run"
    place.mkdir()
    for name, text in scenario_files(twins(events=[event])).items():
        (place / name).write_text(text, encoding="utf-8", newline="")
    assert main(["run", str(place), "--explain", "--out", str(out)]) == 0
    with (out / "intervals.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [(row["binding"], float(row["headroom_kw"])) for row in rows[:2]] == [
        ("line:row 4", 10),
        ("line:row 4", 4),
    ]
    assert main(["audit", str(out)]) == 0
    capsys.readouterr()


def test_what_two_lines_exceed_is_told_of_each() -> None:
    from evdash.checker.feeder import FeederCheck

    scenario = twins()
    found = FeederCheck(scenario).breaches(scenario.load_pu * 20.0)
    assert {one.element for one in violations(found)} == {TWINS[1]}


def test_rows_that_earlier_versions_kept_are_told_apart_by_the_lines() -> None:
    inputs = prepare(twins())
    told = INPUTS.dump_python(inputs, mode="json")
    assert INPUTS.validate_python(told).rows.elements == inputs.rows.elements
    told["rows"]["elements"] = list(names(inputs.rows.elements))
    read = INPUTS.validate_python(told).rows.elements
    assert names(read) == names(inputs.rows.elements)
    assert set(read) <= {*inputs.rows.elements, *TWINS}


def test_a_rating_changes_where_it_is_and_nowhere_else() -> None:
    scenario = edit_scenario(twins(), {})
    for element in scenario.rated_elements.values():
        higher = scenario.with_rating(element, lambda kva: (kva or 0) + 1)
        for other in scenario.rated_elements.values():
            more = 1 if other == element else 0
            assert (higher.rating_kva_of(other) or 0) == (scenario.rating_kva_of(other) or 0) + more


def test_an_event_tells_its_element() -> None:
    event = Event(interval=1, event="rating", subject="line:s-a", value=4.0)
    assert event.text == "the rating of line s-a is 4 kVA from now on"


def test_a_study_of_ones_own_offers_each_line_by_a_key_that_works() -> None:
    scenario = twins()
    keys = _ratings(scenario)
    assert len(keys) == len(scenario.lines)
    for key, rating in keys.items():
        changed = STUDY_KEYS["line."].change(scenario.model_dump(), key.removeprefix("line."), 77.0)
        assert [one["rating_kva"] for one in changed["lines"]].count(77.0) == 1
        assert rating in (None, 40.0, 10.0)
    axis = f'[[axis]]\nkey = "{[*keys][-1]}"\nvalues = [7.0, 9.0]\n'
    study = parse_study(f'format = 1\nname = "twins"\nbase = "x"\n{axis}')
    assert len(lay_out(study, scenario).points) == 2
