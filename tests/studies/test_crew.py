"""Work shared by processes comes back in order, the same, and says so where a process dies."""

import os

import pytest

from evdash.errors import EvdashError
from evdash.explain.refusals import TOGETHER, explained, explanations, refused
from evdash.files.bundled import bundled_scenarios
from evdash.files.scenario_folder import read_scenario
from evdash.studies.crew import in_order
from tests.explain.cases import ran


def squared(number: int) -> int:
    return number * number


def pid_of(_: int) -> int:
    return os.getpid()


def dies_at_three(number: int) -> int:
    if number == 3:
        os._exit(9)
    return number


def test_in_order_and_in_other_processes():
    assert list(in_order(range(20), squared, 2)) == [n * n for n in range(20)]
    assert os.getpid() not in set(in_order(range(6), pid_of, 2))
    assert list(in_order(range(3), pid_of, 1)) == [os.getpid()] * 3
    assert list(in_order([], squared, 2)) == []


def test_a_process_that_dies_is_told():
    with pytest.raises(EvdashError, match="died"):
        list(in_order(range(6), dies_at_three, 2))


def test_a_crowd_is_explained_alike_by_one_process_and_by_two():
    preset = next(folder for folder in bundled_scenarios() if folder.name == "voltage-limited")
    trace = ran(read_scenario(preset, ()))
    groups = list(refused(trace))
    crowd = max(groups, key=lambda asked: len(asked.vehicles))
    assert len(crowd.vehicles) == TOGETHER
    late = [asked for asked in groups if asked.inputs.scenario.intervals - 2 <= asked.state.now]
    one = list(in_order(late, explained, 1))
    assert list(in_order(late, explained, 2)) == one
    told = [explanation.vehicle for some in one for explanation in some]
    assert told
    assert [v for asked in groups for v in asked.vehicles][-len(told) :] == told
    assert next(explanations(trace)).vehicle == groups[0].vehicles[0]
