"""What docs/policies.md says of the race, held against the days that were raced, by pandas."""

import re
from pathlib import Path

import pandas as pd
import pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "policies.md").read_text(encoding="utf-8").replace("−", "-")
LINES = PAGE[PAGE.index("| preset, days |") :].splitlines()
LAWLESS = "uncoordinated"
STUDENT = {100: 1.984217}
"""Student's t at 0.975, by the number of days, from a table."""


@pytest.fixture(scope="module")
def days() -> pd.DataFrame:
    """The days raced with the right forecast, with the gain over P1 on the same day, $."""
    raced = pd.read_csv(ROOT / "data" / "results" / "race.csv")
    right = raced[raced.forecast == "right"].copy()
    p1 = right[right.policy == "p1"].set_index(["preset", "seed"]).profit
    right["gain"] = right.profit - p1.loc[list(zip(right.preset, right.seed, strict=True))].values
    return right


def rows() -> list[tuple[str, int, list[str]]]:
    """(preset, days, cells from the policy on) of the page's table."""
    found, preset, count = [], "", 0
    for line in LINES[2:]:
        if not line.startswith("|"):
            break
        first, *cells = (cell.strip() for cell in line.strip("|").split("|"))
        if first:
            preset, count = first.split(", ")[0], int(first.split(", ")[1])
        found.append((preset, count, cells))
    return found


@pytest.mark.parametrize(("preset", "count", "cells"), rows())
def test_the_table_is_that_of_the_days(
    days: pd.DataFrame, preset: str, count: int, cells: list[str]
) -> None:
    mine = days[(days.preset == preset) & (days.policy == cells[0])]
    assert len(mine) == count
    share = mine.profit / mine.most_profit
    half = STUDENT[count] * share.std() / count**0.5
    mean, width = (float(x) for x in cells[1].strip("*").split(" ± "))
    assert mean == pytest.approx(share.mean(), abs=6e-4)
    assert width == pytest.approx(half, abs=6e-4)
    if cells[2]:
        gain = float(cells[2].split(" ± ")[0])
        assert gain == pytest.approx(mine.gain.mean(), abs=6e-3)
    assert float(cells[3]) == pytest.approx(mine.admitted.mean(), abs=0.051)
    assert [int(cells[4]), int(cells[5])] == [
        mine.broken_limits.sum(),
        mine.broken_promises.sum(),
    ]


def test_days_on_which_bid_price_earned_less_are_those_told(days: pd.DataFrame) -> None:
    told = re.sub(r"\s+", " ", PAGE)
    sentence = told[told.index("It earned less on") : told.index("on none of winter-weekday")]
    found = re.findall(
        r"on (\d+) of (?:the )?([a-z-]+?)(?: days)?, by at most ([\d.]+) \$", sentence
    )
    assert len(found) == 5
    anticipating = days[days.policy == "bid-price"]
    for count, preset, most in found:
        less = anticipating[(anticipating.preset == preset) & (anticipating.gain < -0.005)]
        assert (len(less), round(-less.gain.min(), 2)) == (int(count), float(most))
    winter = anticipating[anticipating.preset == "winter-weekday"]
    assert (winter.gain > -0.005).all()
    assert (anticipating.groupby("preset").gain.mean() > 0).all()


def test_nobody_within_the_limits_broke_one_or_beat_the_bound(days: pd.DataFrame) -> None:
    lawful = days[days.policy != LAWLESS]
    assert lawful.broken_limits.sum() == lawful.broken_promises.sum() == 0
    assert (lawful.profit <= lawful.most_profit + 0.01).all()
    spike = days[(days.preset == "price-spike") & days.policy.isin(["fcfs", "edf", "llf", LAWLESS])]
    assert (spike.profit < 0).all()
