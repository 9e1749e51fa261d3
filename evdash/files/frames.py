"""Tables as pandas frames: the rows that the CSV files are written from, typed by their records."""

from collections.abc import Iterable, Sequence
from datetime import datetime
from typing import TypeVar

import pandas as pd
from pydantic import BaseModel

Row = TypeVar("Row", bound=BaseModel)
TYPES: dict[object, str] = {
    int: "int64",
    float: "float64",
    float | None: "float64",
    int | None: "Int64",
    datetime: "datetime64[s]",
}
"""What a column holds, by its field's type; every other is text."""


def frame(record: type[Row], rows: Iterable[Row]) -> pd.DataFrame:
    """Rows as a frame with the columns of their record.

    None is NaN or, among whole numbers, NA. `attrs["units"]` has the unit of every column that has
    one, `attrs["meanings"]` what a column means.
    """
    fields = record.model_fields
    cells = [[getattr(row, name) for name in fields] for row in rows]
    types = {name: TYPES.get(field.annotation, "object") for name, field in fields.items()}
    made = pd.DataFrame(cells, columns=list(fields)).astype(types)
    made.attrs["units"] = {
        name: extra["unit"]
        for name, field in fields.items()
        if isinstance(extra := field.json_schema_extra, dict) and extra.get("unit")
    }
    made.attrs["meanings"] = {name: field.description for name, field in fields.items()}
    return made


def table_frame(header: Sequence[str], rows: Iterable[Sequence[object]]) -> pd.DataFrame:
    """A table that has no record, such as a race's or a study's, with the types of its cells."""
    return pd.DataFrame([list(row) for row in rows], columns=list(header)).infer_objects()
