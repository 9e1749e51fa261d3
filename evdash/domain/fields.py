"""Kinds of value a scenario is made of.

`quantity`, `count` and `text` declare a field once: its unit, meaning and bounds serve
validation, the documentation and the help texts of the app.
"""

from typing import Annotated, Any

from pydantic import Field, Strict, StringConstraints

NAME_PATTERN = r"^\w[^\x00-\x1f\x7f]*$"
Name = Annotated[str, StringConstraints(strip_whitespace=True, max_length=60, pattern=NAME_PATTERN)]
"""Text naming a node, vehicle or option. It begins with a letter or digit, so that no
spreadsheet takes an exported cell for a formula, and holds no control characters."""

Number = Annotated[float, Strict()]
"""A number that TOML itself wrote as one (no text, no true/false)."""

Count = Annotated[int, Strict()]


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
