"""Settings of all tests."""

import atexit
import os
import shutil
import tempfile
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

from evdash.store.place import VARIABLE

# No test keeps its runs where a person keeps theirs.
os.environ[VARIABLE] = tempfile.mkdtemp(prefix="evdash-tests-")
atexit.register(shutil.rmtree, os.environ[VARIABLE], ignore_errors=True)

# The same examples on every run and machine, and no deadline: a test never fails on time.
settings.register_profile(
    "ci",
    derandomize=True,
    deadline=None,
    max_examples=40,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.data_too_large],
)
# More examples, and new ones each time: `pytest --hypothesis-profile=long`.
settings.register_profile("long", deadline=None, max_examples=1000)
settings.load_profile("ci")

HERE = Path(__file__).parent
QUICK = {
    "charts",
    "checker",
    "data",
    "domain",
    "horizon",
    "metrics",
    "scheduling",
    "test_layers.py",
}
"""Folders and files whose tests are marked quick, but for the few of them that are not."""
SLOW = {
    "test_ac_process.py",
    "test_against_reference.py",
    "test_impossible.py",
    "test_starved.py",
}


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    for item in items:
        place = item.path.relative_to(HERE)
        if place.parts[0] in QUICK and place.name not in SLOW:
            item.add_marker(pytest.mark.quick)
