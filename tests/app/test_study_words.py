"""What a study says of the best it found."""

import pytest

from evdash.ui.studies.words import edge


@pytest.mark.parametrize(
    ("best", "tried", "told"),
    [
        (12, {4, 8, 12}, " (the most tried)"),
        (0.2, {0.2, 0.3}, " (the least tried)"),
        (8, {4, 8, 12}, ""),
        ("634", {"634", "646"}, ""),
        (8, {8, "none"}, ""),
    ],
)
def test_the_best_at_an_end_of_what_was_tried_says_so(best: object, tried: set, told: str) -> None:
    assert edge(best, tried) == told
