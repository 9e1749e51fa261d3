"""Numbers as typed: read as they stand, or refused with what may have been meant."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.files.numbers import number_rule, number_text, read_number

READ = {
    "4.5": 4.5,
    ".19": 0.19,
    "5.": 5.0,
    " 5 ": 5.0,
    "1e3": 1000.0,
    "1.234": 1.234,
    "-0.5": -0.5,
    "−5": -5.0,
    "+2": 2.0,
    "\u00a07\u00a0": 7.0,
}
REFUSED = {
    "4,5": "4.5",
    "0,3": "0.3",
    ",19": "0.19",
    "-,5": "-0.5",
    "1.234,5": "1234.5",
    "1,234.5": "1234.5",
    "1,234": "1234 or 1.234",
    "0,123": "0.123",
    "1,234,567": "1234567",
    "5 kW": "5",
    "20%": "20",
    "1 000": "1000",
}
NONSENSE = (
    "",
    " ",
    "-",
    "1.2.3",
    "0x1F",
    "1_000",
    "12,",
    "4,5,6",
    "nan",
    "inf",
    "7'000",
    "five",
)


@pytest.mark.parametrize("text", READ)
def test_a_number_is_read_as_it_stands(text: str) -> None:
    assert read_number(text) == READ[text]


@pytest.mark.parametrize("text", REFUSED)
def test_what_may_mean_something_else_is_refused_with_what_was_meant(text: str) -> None:
    with pytest.raises(ValueError, match=r"^should be a number.*: ") as refused:
        read_number(text)
    assert str(refused.value).endswith(f": {REFUSED[text]}")


@pytest.mark.parametrize("text", NONSENSE)
def test_what_is_no_number_is_refused_without_a_guess(text: str) -> None:
    for whole in (False, True):
        with pytest.raises(ValueError, match=r"number$"):
            read_number(text, whole=whole)


@pytest.mark.parametrize("text", ["1.5", "1,5", "1.000", "1e3", ".19", "12.0", "1,234"])
def test_whole_numbers_are_digits_and_nothing_else(text: str) -> None:
    with pytest.raises(ValueError, match="should be a whole number"):
        read_number(text, whole=True)
    assert read_number(" 9007199254740993", whole=True) == 2**53 + 1


def test_numbers_beyond_all_bounds_are_refused() -> None:
    for text in ("1e999", "-1e999", "9" * 400):
        with pytest.raises(ValueError, match="should be"):
            read_number(text)


@given(st.floats(allow_nan=False, allow_infinity=False) | st.integers(-(2**53), 2**53))
def test_what_a_field_shows_is_read_as_the_same_number(value: float) -> None:
    assert read_number(number_text(value), whole=isinstance(value, int)) == value


@given(st.text("0123456789.,+-−eE _'k", max_size=12), st.booleans())
def test_nothing_is_read_otherwise_than_python_would(text: str, whole: bool) -> None:
    """Whatever is read is what the digits, signs and points say with none of them left out."""
    try:
        number = read_number(text, whole=whole)
    except ValueError:
        return
    assert "," not in text
    assert number == float(text.replace("−", "-"))
    assert math.isfinite(number)
    assert isinstance(number, int) == whole


@given(st.text("0123456789.,+- k", max_size=12), st.booleans())
def test_every_suggestion_can_be_read(text: str, whole: bool) -> None:
    _, colon, suggestions = number_rule(text, whole=whole).partition(": ")
    for suggestion in suggestions.split(" or ") if colon else ():
        read_number(suggestion, whole=whole)
