"""However a scenario's files are damaged: a Scenario or an InputError, and nothing else."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.scenario import Scenario
from evdash.errors import InputError
from evdash.files.scenario_folder import parse_scenario
from evdash.grid.reduction import limit_rows
from evdash.horizon.inputs import prepare
from tests.files.spoiling import files_of, generated_scenario, recorded_scenario

VALID = [files_of(recorded_scenario()), files_of(generated_scenario())]
TOKENS = [
    *(
        "",
        " ",
        ",",
        "\n",
        '"',
        "=",
        "[",
        "]",
        "[[option]]",
        "{",
        "}",
        "\0",
        "\ufeff",
        "true",
        "nan",
    ),
    *("-1", "0", "1e308", "1e-320", "5e-324", "9" * 40, "0.5", "634", "a", "C1", "00:00", "é", "."),
    *("1900-01-01T00:00", "2999-12-31T23:59", "fleet.csv", "arrivals.csv", "inf", "#", "\\", "'"),
]


@st.composite
def damaged(draw):
    """The files of a valid scenario, a few of their pieces exchanged, doubled, cut or moved."""
    files = dict(draw(st.sampled_from(VALID)))
    for _ in range(draw(st.integers(1, 4))):
        name = draw(st.sampled_from(sorted(files)))
        content = files[name]
        begin = draw(st.integers(0, len(content)))
        end = min(len(content), begin + draw(st.integers(0, 12)))
        token = draw(st.sampled_from(TOKENS) | st.text(max_size=5))
        how = draw(st.sampled_from(["piece", "cell", "byte", "cut", "line", "drop", "swap"]))
        if how == "piece":
            content = content[:begin] + token.encode("utf-8", "replace") + content[end:]
        elif how == "cell":
            content = _cell_exchanged(content, begin, token.encode("utf-8", "replace"))
        elif how == "byte":
            content = content[:begin] + bytes([draw(st.integers(0, 255))]) + content[begin + 1 :]
        elif how == "cut":
            content = content[:begin]
        elif how == "line":
            lines = content.splitlines(keepends=True)
            content = b"".join([*lines, *lines[begin % (len(lines) + 1) :]])
        if how == "drop":
            del files[name]
            if not files:
                break
        elif how == "swap":
            files[name] = files[draw(st.sampled_from(sorted(files)))]
        else:
            files[name] = content
    return files


def _cell_exchanged(content, begin, token):
    """The cell or value around a place exchanged as a whole."""
    marks = b",\n= []"
    start = max(content.rfind(bytes([mark]), 0, begin) for mark in marks) + 1
    ends = [content.find(bytes([mark]), begin) for mark in marks]
    end = min((place for place in ends if place >= 0), default=len(content))
    return content[:start] + token + content[end:]


def outcome(files):
    faults = ()
    try:
        return parse_scenario(files)
    except InputError as error:
        faults = error.faults
    assert faults
    assert all(fault.place and fault.found and fault.allowed for fault in faults)
    assert len(set(faults)) == len(faults)
    return None


@settings(max_examples=600)
@given(files=damaged())
def test_damaged_files_give_a_scenario_or_an_input_error(files):
    scenario = outcome(files)
    if scenario is not None:
        _can_be_prepared(scenario)


@pytest.mark.long
@settings(max_examples=20_000)
@given(files=damaged())
def test_damaged_files_give_a_scenario_or_an_input_error_many_times(files):
    scenario = outcome(files)
    if scenario is not None:
        _can_be_prepared(scenario)


def _can_be_prepared(scenario: Scenario):
    """What validation lets through can be computed with."""
    known = scenario.arrivals
    if isinstance(known, GeneratedArrivals) and known.vehicles_per_day > 1000:
        limit_rows(scenario)  # valid, but long to draw
    else:
        prepare(scenario)
