"""What a run of HiGHS says, told apart from what it only seems to say."""

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from evdash.scheduling.effort import Effort
from evdash.scheduling.highs import WHOLE, LinearProgram, Session


def one_column(lower: float = 0.0) -> Session:
    """min −x, 2x ≤ 7, lower ≤ x ≤ 10."""
    return Session(
        LinearProgram(
            cost=np.array([-1.0]),
            matrix=csr_matrix([[2.0]]),
            row_lower=np.array([-np.inf]),
            row_upper=np.array([7.0]),
            lower=np.array([lower]),
            upper=np.array([10.0]),
        )
    )


@pytest.mark.parametrize(("kind", "value"), [(0, 3.5), (WHOLE, 3.0)], ids=["continuous", "whole"])
def test_the_bound_is_that_of_the_program_even_with_nothing_to_branch_over(kind, value):
    outcome = one_column().branched(np.full(1, kind, dtype=np.uint8), Effort(), nodes=10)
    assert outcome.values == pytest.approx([value])
    assert outcome.bound == pytest.approx(-value)


@pytest.mark.parametrize("kind", [0, WHOLE])
def test_an_infeasible_program_has_no_values_and_no_finite_bound(kind):
    outcome = one_column(lower=4.0).branched(np.full(1, kind, dtype=np.uint8), Effort(), nodes=10)
    assert outcome.values is None
    assert outcome.bound == np.inf
