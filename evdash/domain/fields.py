"""Kinds of value a scenario is made of.

`quantity`, `count` and `text` declare a field once: its unit, meaning and bounds serve
validation, the documentation and the help texts of the app.
"""

from typing import Annotated, Any

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, Strict, StringConstraints

# Bounds beyond anything real, so that no computation meets a number it cannot hold.
LARGE = 1e9
SMALL = 0.01


class Record(BaseModel):
    """A frozen record that refuses unknown fields and numbers that are not finite."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, str_strip_whitespace=True
    )


def _blank_is_none(value: object) -> object:
    return None if isinstance(value, str) and not value.strip() else value


UNSEEN = (
    r"\x00-\x1f\x7f-\x9f\u2028\u2029"  # control characters, ends of lines
    r"\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # turn the direction of what follows
)
"""Characters that move what stands around them, as part of a pattern."""
NAME_PATTERN = rf"^\w[^{UNSEEN}]*$"
TITLE_PATTERN = rf"^[^{UNSEEN}]+$"
Title = Annotated[
    str, StringConstraints(strip_whitespace=True, max_length=200, pattern=TITLE_PATTERN)
]
"""Text for people, in one line: what a scenario or a study is called."""
Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=60, pattern=NAME_PATTERN)]
"""Text naming a node, vehicle or option. It begins with a letter or digit, so that no
spreadsheet takes an exported cell for a formula, and holds nothing that is not seen."""

Number = Annotated[float, Strict()]
"""A number that TOML itself wrote as one (no text, no true/false)."""

Count = Annotated[int, Strict()]

OptionalNumber = Annotated[float | None, BeforeValidator(_blank_is_none)]
OptionalCount = Annotated[int | None, BeforeValidator(_blank_is_none)]


def declare(description: str, unit: str, example: Any, **bounds: Any) -> Any:
    """Declare a field: meaning, unit, an example that is valid anywhere, and bounds."""
    return Field(
        description=description, examples=[example], json_schema_extra={"unit": unit}, **bounds
    )


def declare_optional(description: str, unit: str, **bounds: Any) -> Any:
    """Declare a field that may be left out or blank, which then means none."""
    return Field(
        default=None,
        description=description,
        examples=[None],
        json_schema_extra={"unit": unit},
        **bounds,
    )


def declare_default(description: str, unit: str, default: Any, **bounds: Any) -> Any:
    """Declare a field that may be left out and then has the value told in its documentation."""
    return Field(
        default=default,
        description=description,
        examples=[default],
        json_schema_extra={"unit": unit},
        **bounds,
    )
