"""Digests that stand for whole values in caches: another value is another digest."""

import ast
import dataclasses
from collections.abc import Iterator
from datetime import timedelta
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from evdash.domain.digest import digest
from evdash.domain.plan import Snapshot
from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import start_day, step
from evdash.metrics.ac_kept import feeder_key
from evdash.scheduling.p1 import p1_policy

EVDASH = Path(__file__).parents[2] / "evdash"


@pytest.fixture(scope="module")
def snapshot() -> Snapshot:
    """One in mid-day, with contracts and requests."""
    seen: list[Snapshot] = []
    solve = p1_policy()

    def watched(given: Snapshot) -> Any:
        seen.append(given)
        return solve(given)

    trace = start_day(read_scenario(DEFAULT))
    for _ in range(19):
        trace = step(trace, watched)
    return next(one for one in reversed(seen) if one.contracts and one.requests)


def others(value: Any) -> Iterator[Any]:
    """Values like a given one that differ from it in one place."""
    if isinstance(value, np.ndarray):
        for place in {0, value.size - 1} if value.size else ():
            changed = value.copy()
            changed.flat[place] = np.nextafter(changed.flat[place], np.inf)
            yield changed
        yield np.append(value, 1.0)
    elif isinstance(value, tuple):
        yield (*value, "one more")
        for place, each in enumerate(value):
            yield value[:place] + value[place + 1 :]
            for other in others(each):
                yield (*value[:place], other, *value[place + 1 :])
    elif dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            for other in others(getattr(value, field.name)):
                yield dataclasses.replace(value, **{field.name: other})
    elif hasattr(value, "model_copy"):
        for name in type(value).model_fields:
            for other in others(getattr(value, name)):
                yield value.model_copy(update={name: other})
    else:
        yield from other_scalars(value)


def other_scalars(value: Any) -> Iterator[Any]:
    if isinstance(value, bool | type(None)):
        yield "something else"
    elif isinstance(value, int | float):
        yield value + 1
        yield np.nextafter(float(value), np.inf).item()
    elif isinstance(value, str):
        yield f"{value}x"
    else:
        yield value + timedelta(days=1)


def test_all_that_a_snapshot_says_is_in_the_key_of_its_plan(snapshot: Snapshot) -> None:
    """Else one visitor would be handed a plan made for another's chargers, prices or promises."""
    key = digest(snapshot)
    changed = list(others(snapshot))
    names = {field.name for field in dataclasses.fields(Snapshot)}
    assert len(changed) > 10 * len(names)
    for other in changed:
        assert digest(other) != key, other


def test_all_that_a_feeder_says_is_in_the_key_of_its_ac_state() -> None:
    scenario = read_scenario(DEFAULT)
    key = digest(feeder_key(scenario))
    for other in others(feeder_key(scenario)):
        assert digest(other) != key, other


def test_feeders_that_differ_by_minus_one_and_minus_two_are_told_apart() -> None:
    scenario = read_scenario(DEFAULT)
    assert hash(-1.0) == hash(-2.0)  # why Python's own hash is no key
    keys = set()
    for load_kvar in (-1.0, -2.0):
        nodes = list(scenario.nodes)
        nodes[-1] = nodes[-1].model_copy(update={"load_kvar": load_kvar})
        keys.add(digest(feeder_key(scenario.model_copy(update={"nodes": tuple(nodes)}))))
    assert len(keys) == 2


values = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text(),
    lambda inner: st.lists(inner, max_size=4).map(tuple),
    max_leaves=8,
)


@given(values, values)
def test_other_values_have_other_digests(one: object, other: object) -> None:
    """By `repr`, which tells 1 from 1.0 and True; the same value has the same digest."""
    assert (digest(one) == digest(other)) == (repr(one) == repr(other))


def test_parts_do_not_run_into_each_other() -> None:
    assert digest("ab", "c") != digest("a", "bc")
    assert digest(("a",), "b") != digest(("a", "b"))
    assert digest(np.zeros((2, 3))) != digest(np.zeros((3, 2)))


@pytest.mark.parametrize("unknown", [object(), {1, 2}, np.array([object()]), Snapshot])
def test_what_cannot_be_looked_into_is_refused(unknown: object) -> None:
    with pytest.raises(TypeError, match="no digest"):
        digest(unknown)


def test_nothing_is_known_by_the_hash_of_python() -> None:
    """It differs from process to process for texts, and is the same for -1.0 and -2.0."""
    calls = [
        f"{path.relative_to(EVDASH)}:{node.lineno}"
        for path in sorted(EVDASH.rglob("*.py"))
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "hash"
    ]
    assert calls == []
