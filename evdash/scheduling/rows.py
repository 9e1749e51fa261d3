"""Rows of a linear program, gathered block by block as arrays."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.sparse import csr_matrix

from evdash.domain.limits import Floats

Indices = NDArray[np.intp]
Entries = tuple[Indices, Indices, ArrayLike]
"""Row within the block, column, coefficient; the coefficient may be one number for all."""


@dataclass(slots=True)
class Rows:
    """Blocks of rows so far; `add` appends one."""

    count: int = 0
    row: list[Indices] = field(default_factory=list)
    column: list[Indices] = field(default_factory=list)
    value: list[Floats] = field(default_factory=list)
    lower: list[Floats] = field(default_factory=list)
    upper: list[Floats] = field(default_factory=list)

    def add(self, n_rows: int, lower: ArrayLike, upper: ArrayLike, *blocks: Entries) -> None:
        """Append `n_rows` rows: lower ≤ Σ blocks ≤ upper."""
        for row, column, value in blocks:
            self.row.append(row + self.count)
            self.column.append(column)
            self.value.append(_spread(value, len(row)))
        self.lower.append(_spread(lower, n_rows))
        self.upper.append(_spread(upper, n_rows))
        self.count += n_rows

    def limits(self) -> tuple[Floats, Floats]:
        """Lower and upper limit of every row so far."""
        if self.count == 0:
            return np.empty(0), np.empty(0)
        return np.concatenate(self.lower), np.concatenate(self.upper)

    def matrix(self, n_columns: int) -> csr_matrix:
        """All rows so far as one sparse matrix; a column appears once in a row."""
        if self.count == 0:
            return csr_matrix((0, n_columns))
        row, value = np.concatenate(self.row), np.concatenate(self.value)
        order = np.argsort(row, kind="stable")
        starts = np.zeros(self.count + 1, dtype=np.int32)
        np.cumsum(np.bincount(row, minlength=self.count), out=starts[1:])
        columns = np.concatenate(self.column)[order].astype(np.int32)
        return csr_matrix((value[order], columns, starts), shape=(self.count, n_columns))


def _spread(value: ArrayLike, length: int) -> Floats:
    array = np.empty(length)
    array[:] = value
    return array
