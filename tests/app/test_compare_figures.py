"""Differences between runs, as they are told."""

import pytest

from evdash.ui.compare.figures import Figure, difference


@pytest.mark.parametrize(
    ("form", "base", "value", "told"),
    [
        (".4f", 0.97464, 0.97466, "+0.0001"),  # 0.9746 beside 0.9747
        (".4f", 0.97461, 0.97464, "="),  # both 0.9746
        (",.2f", 1255.774, 1285.536, "+29.77"),
        (",.0f", 51.0, 47.0, "−4"),
    ],
)
def test_a_difference_is_that_of_the_numbers_beside_it(
    form: str, base: float, value: float, told: str
) -> None:
    assert difference(Figure("", lambda _: None, form), base, value) == told
