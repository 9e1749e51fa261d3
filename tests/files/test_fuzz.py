"""The short form of `benchmarks.fuzz`: every kind of bad input, a few dozen of each."""

import io
import zipfile

import pytest

from benchmarks.fuzzing import archives, trial, watched
from benchmarks.fuzzing.folders import base
from benchmarks.fuzzing.kinds import KINDS, answered, made
from benchmarks.fuzzing.trial import ALLOWED, Outcome
from evdash.errors import Fault, InputError

SEED, MOST = 7, 12
FOUND = [
    *(("scenario folder", number) for number in (209, 1179, 4965, 5588)),
    *(("scenario page", number) for number in (219, 276)),
    *(("pandapower .json", number) for number in (283, 1010, 1281)),
    *(("workbook", number) for number in (140, 1271)),
    ("session table", 1259),
    ("study file", 1272),
]
"""What the first twenty thousand of seed 1 found."""


@pytest.mark.parametrize("name", KINDS)
@pytest.mark.filterwarnings("ignore")
def test_bad_input_is_refused_in_words_or_runs_right(name):
    outcomes = [answered(name, SEED, number) for number in range(MOST)]
    assert [(n, one) for n, one in enumerate(outcomes) if one.kind not in ALLOWED] == []
    assert any(one.kind == trial.REFUSED for one in outcomes)


@pytest.mark.parametrize(("name", "number"), FOUND)
@pytest.mark.filterwarnings("ignore")
def test_what_was_found_once_is_answered_rightly(name, number):
    assert answered(name, 1, number).problem == ""


def test_the_same_seed_gives_the_same_input():
    assert made("zip", SEED, 3) == made("zip", SEED, 3)
    assert made("zip", SEED, 3) != made("zip", SEED, 4)


def test_valid_input_runs():
    assert trial.folder(dict(base(0))) == Outcome(trial.RAN)
    assert trial.archive(archives.plain(dict(base(1)), "day/")) == Outcome(trial.RAN)


@pytest.mark.parametrize(
    "fault", [Fault("", "a", "b"), Fault("nodes.csv", "<object object at 0x7f>", "b")]
)
def test_refusals_nobody_can_read_are_told(fault):
    assert trial.refusal(InputError([fault])).kind == trial.WRONG
    assert trial.refusal(InputError([])).kind == trial.WRONG


def test_an_error_is_told_and_the_rest_goes_on():
    outcomes = list(watched.tried_all([("nobody's kind", 1), ("zip", 1)], SEED))
    assert [one.outcome.kind for one in outcomes] == [
        trial.WRONG,
        answered("zip", SEED, 1).kind,
    ]
    assert "KeyError" in outcomes[0].outcome.problem


def test_bombs_hold_more_than_is_taken():
    content = archives.plain({"nodes.csv": b"0" * archives.BOMB_BYTES})
    assert len(content) < 200_000
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        assert archive.infolist()[0].file_size == archives.BOMB_BYTES
    assert trial.archive(content).kind == trial.REFUSED
