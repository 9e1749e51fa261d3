"""Values a field may be given: at its bounds, beyond them, of another kind, hostile."""

from collections.abc import Iterator
from datetime import date, datetime
from typing import Any, get_args, get_origin

import numpy as np
from pydantic import BaseModel
from pydantic.fields import FieldInfo

HAIR = 1e-9
HOSTILE_TEXTS = (
    *("", " ", "\t", "nan", "inf", "-inf", "1e400", "1e-320", "-0", "0x10", "1_000", "1,5"),
    *("=1+1", "@SUM(A1)", "-1", "+1", "\ufeff1", "１２", "٣", "½", "1\u00a0000", "true", "None"),
    *("<b>bold</b>", "<img src=x onerror=alert(1)>", "![x](http://10.255.255.1/a.png)", "$x^2$"),
    *("a\x00b", "a\nb", 'a"b', "a,b", "a;b", "é", "e\u0301", "\u202eabc", "\u200b", "😀", "n" * 61),
    *("n" * 5000, "../../etc/passwd", "C:\\x", "%s%n", "{0}", "' OR 1=1 --", ":red[x]", "a.b.c"),
    *("2024-02-30T00:00", "2999-12-31T23:59", "24:00", "23:59", "0:00", "2024-05-06T00:00Z"),
)
HOSTILE_VALUES: tuple[Any, ...] = (
    *(0, -1, 1, 2**31, 2**53, 2**63 - 1, 2**63, 10**40, -(10**40)),
    *(0.0, -0.0, 1e-320, 5e-324, 1e-12, 1e9, 1e300, -1e300),
    *(float("nan"), float("inf"), float("-inf")),
    *(True, False, [], {}, [1], {"a": 1}, [[1]], [{}], date(2024, 5, 6), datetime(2024, 5, 6)),
)


def pick(rng: np.random.Generator, choices: Any) -> Any:
    """One of some choices, as it is."""
    return choices[int(rng.integers(0, len(choices)))]


def hostile_text(rng: np.random.Generator) -> str:
    """A text nobody would want in a cell, or random code points."""
    if rng.random() < 0.8:
        return str(pick(rng, HOSTILE_TEXTS))
    points = rng.choice([32, 127, 255, 0x2FF, 0xD7FF, 0x10FFFF], size=int(rng.integers(1, 8)))
    text = "".join(chr(int(rng.integers(1, top + 1))) for top in points)
    return text.encode("utf-8", "ignore").decode()


def hostile_value(rng: np.random.Generator) -> Any:
    """A value of any kind TOML has."""
    return hostile_text(rng) if rng.random() < 0.4 else pick(rng, HOSTILE_VALUES)


def edges(field: FieldInfo) -> list[Any]:
    """Numbers at, just within and just beyond a field's declared bounds; empty if it has none."""
    whole = any(kind is int for kind in _kinds(field.annotation))
    found: list[Any] = []
    for mark in field.metadata:
        for name in ("ge", "gt", "le", "lt"):
            bound = getattr(mark, name, None)
            if bound is None:
                continue
            steps = (-1, 0, 1) if whole else (-HAIR, 0.0, HAIR, -1.0, 1.0)
            found += [int(bound) + step if whole else float(bound) + step for step in steps]
    return found


def _kinds(annotation: Any) -> Iterator[Any]:
    yield annotation
    for part in get_args(annotation):
        yield from _kinds(part)


def field_of(record: type[BaseModel], way: tuple[str, ...]) -> FieldInfo | None:
    """The declaration of a key, `("station", "chargers")`; None where there is none."""
    field: FieldInfo | None = None
    inner: type[BaseModel] | None = record
    for part in way:
        if inner is None or part not in inner.model_fields:
            return None
        field = inner.model_fields[part]
        inner = _record_in(field.annotation)
    return field


def _record_in(annotation: Any) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    if get_origin(annotation) is dict:
        return None
    return next((r for part in get_args(annotation) if (r := _record_in(part))), None)


def value_for(rng: np.random.Generator, field: FieldInfo | None) -> Any:
    """Something to put where `field` is declared: an edge of its bounds or anything at all."""
    known = edges(field) if field is not None else []
    if known and rng.random() < 0.6:
        return pick(rng, known)
    return hostile_value(rng)
