"""One digest for every cache whose keys stand for whole values.

Python's own `hash` will not do: it is made for tables that compare afterwards, and says the same
of -1.0 and -2.0.
"""

import hashlib
from collections.abc import Iterator
from dataclasses import fields, is_dataclass
from datetime import date, time
from typing import Any

import numpy as np
from pydantic import BaseModel

DIGEST_BYTES = 20
AS_SAID = (str, bool, int, float, bytes, date, time, type(None))
"""Types whose `repr` says all of a value, floats in full precision."""


def digest(*values: object) -> bytes:
    """A digest of values by all that they say: of other values, it is another.

    Takes numbers, texts, times and arrays, and records, tuples and mappings of them; raises
    TypeError for anything else, since what is not looked into might differ unseen.
    """
    made = hashlib.blake2b(digest_size=DIGEST_BYTES)
    for piece in _pieces(values):
        made.update(len(piece).to_bytes(8, "little"))
        made.update(piece)
    return made.digest()


def _pieces(value: Any) -> Iterator[bytes]:
    """Every part of a value in order, each opened by what it is and how much of it follows."""
    if isinstance(value, AS_SAID):
        yield f"{type(value).__name__} {value!r}".encode()
    elif isinstance(value, np.ndarray) and not value.dtype.hasobject:
        yield f"array {value.dtype.str} {value.shape}".encode()
        yield np.ascontiguousarray(value).tobytes()
    elif isinstance(value, tuple | list):
        yield f"sequence {len(value)}".encode()
        for each in value:
            yield from _pieces(each)
    elif isinstance(value, dict):
        yield f"mapping {len(value)}".encode()
        for pair in value.items():
            yield from _pieces(pair)
    elif isinstance(value, BaseModel) or (is_dataclass(value) and not isinstance(value, type)):
        yield f"record {type(value).__name__}".encode()
        for name in _names(value):
            yield from _pieces((name, getattr(value, name)))
    else:
        raise TypeError(f"a {type(value).__name__} has no digest")


def _names(record: Any) -> Iterator[str]:
    if isinstance(record, BaseModel):
        yield from type(record).model_fields
    else:
        yield from (field.name for field in fields(record))
