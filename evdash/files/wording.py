"""What a fault says: pydantic's findings in the words of someone who plans feeders."""

import operator
from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import Any

import annotated_types
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from evdash.domain.fields import TITLE_PATTERN
from evdash.files.numbers import FINITE, NUMBER, WHOLE, number_rule

TABLE = "should be a table of keys"
WORDS = {
    "missing": "should be given",
    "string_type": "should be text",
    "string_too_short": "should not be blank",
    "string_too_long": "should have at most {max_length} characters",
    "float_type": NUMBER,
    "float_parsing": NUMBER,
    "finite_number": FINITE,
    "int_type": WHOLE,
    "int_parsing": WHOLE,
    "int_parsing_size": WHOLE + ", and not as large",
    "int_from_float": WHOLE,
    "greater_than": "should be above {gt}",
    "greater_than_equal": "should be at least {ge}",
    "less_than": "should be below {lt}",
    "less_than_equal": "should be at most {le}",
    "tuple_type": "should be a list",
    "too_short": "should have at least {min_length} entries, has {actual_length}",
    "too_long": "should have at most {max_length} entries, has {actual_length}",
    "dict_type": TABLE,
    "model_type": TABLE,
    "model_attributes_type": TABLE,
}
LONGEST = 60
MARKS: Mapping[type, tuple[str, str, Callable[[Any, Any], bool]]] = {
    annotated_types.Ge: ("ge", "at least", operator.ge),
    annotated_types.Gt: ("gt", "above", operator.gt),
    annotated_types.Le: ("le", "at most", operator.le),
    annotated_types.Lt: ("lt", "below", operator.lt),
}


def allowed(details: ErrorDetails) -> str:
    """What would have been right in place of what was found."""
    kind = details["type"]
    if kind == "string_pattern_mismatch":
        return _allowed_text(str(details["input"]), details["ctx"]["pattern"])
    if WORDS.get(kind) in (NUMBER, WHOLE) and isinstance(details["input"], str):
        return number_rule(details["input"], whole=WORDS[kind] == WHOLE)
    if kind in WORDS:
        return WORDS[kind].format_map(_tidy(details.get("ctx", {})))
    message = str(details["msg"]).removeprefix("Value error, ").replace("Input should", "should")
    return message[:1].lower() + message[1:]


def _allowed_text(text: str, pattern: str) -> str:
    if not text.strip():
        return "should not be blank"
    begin = "" if pattern == TITLE_PATTERN else "begin with a letter or digit and "
    return f"should {begin}hold no control characters, such as line breaks"


def _tidy(numbers: Mapping[str, Any]) -> dict[str, object]:
    """Bounds as a person writes them: 10000 and not 10000.0."""
    return {
        name: int(value) if isinstance(value, float) and value.is_integer() else value
        for name, value in numbers.items()
    }


def found(details: ErrorDetails) -> str:
    """What stands there, as the file has it."""
    return "nothing" if details["type"] == "missing" else shown(details["input"])


def shown(value: object) -> str:
    """A value as a file has it, shortened where it is long."""
    if value is None or (isinstance(value, str) and not value.strip()):
        return "a blank"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, Mapping):
        return "a table"
    if isinstance(value, list | tuple):
        return f"a list of {len(value)}"
    if isinstance(value, int) and value.bit_length() > 4 * LONGEST:
        return "a number too long to print"
    text = repr(value) if isinstance(value, str) else str(value)
    return text if len(text) <= LONGEST else text[: LONGEST - 1] + "…"


def meaning(field: FieldInfo | None) -> str:
    """What a field stands for and its unit, in brackets, or nothing."""
    if field is None or not field.description:
        return ""
    extra = field.json_schema_extra
    unit = str(extra.get("unit") or "") if isinstance(extra, dict) else ""
    told = not unit or unit.lower() in field.description.lower()
    return f" ({field.description})" if told else f" ({field.description}, {unit})"


def allowed_words(field: FieldInfo) -> str:
    """What a field allows, `at least 0, at most 100`; empty where it says nothing."""
    return ", ".join(f"{word} {bound:,.10g}" for word, bound, _ in _bounds(field.metadata))


def beyond(number: float, marks: Iterable[object]) -> str:
    """Which of a field's bounds a number is beyond, `should be above 0`; empty where of none."""
    for word, bound, holds in _bounds(marks):
        if not holds(number, bound):
            return f"should be {word} {bound:,.10g}"
    return ""


def _bounds(marks: Iterable[object]) -> Iterator[tuple[str, Any, Callable[[Any, Any], bool]]]:
    for mark in marks:
        for kind, (name, word, holds) in MARKS.items():
            if isinstance(mark, kind):
                yield word, getattr(mark, name), holds
