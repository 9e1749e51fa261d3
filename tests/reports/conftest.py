"""Accounts of finished days, each made once: a usual one, and one of hostile names."""

import pytest

from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.files.bundled import DEFAULT
from evdash.files.run_export import RunLabel
from evdash.files.scenario_folder import read_scenario
from evdash.horizon.day import run_day, start_day
from evdash.reports.account import Account, account, verdict_on
from evdash.scheduling.p1 import p1_policy
from tests.builders import line, make_scenario, node, vehicle

HOSTILE = "x</script><img src=y onerror=alert(1)>&'\"{{7*7}}"
"""Text of a user's that must be shown as it is, wherever it stands."""


def finished(scenario: Scenario) -> Trace:
    return run_day(start_day(scenario), p1_policy())


def account_of(scenario: Scenario, **told: object) -> Account:
    label = RunLabel("p1", "lindistflow", scenario.arrivals.seed, 1.0)
    trace = finished(scenario)
    return account(trace, verdict_on(trace), label, **told)


@pytest.fixture(scope="session")
def usual() -> Account:
    return account_of(read_scenario(DEFAULT))


@pytest.fixture(scope="session")
def hostile() -> Account:
    """Names of nodes, vehicles, options and the scenario that would be something else in HTML,
    in a cell or in a file name; chargers fail, so that promises break."""
    b, v = f"b{HOSTILE}"[:60], f"V{HOSTILE}"[:60]
    scenario = make_scenario(
        name=f"={HOSTILE}",
        nodes=[node("s"), node("a", load_kw=40), node(b, load_kw=20)],
        lines=[line("s", "a", rating=90.0), line("a", b)],
        price=(0.1, -0.3, 0.2, 0.05),
        options=[
            {"name": f"C{HOSTILE}"[:60], "price_per_kwh": 0.4, "average_kw": 8.0},
            {"name": "C1", "price_per_kwh": 0.3, "average_kw": 4.0},
        ],
        vehicles=[vehicle(f"{v[:58]}{n}", n / 4, need_kwh=12 + n) for n in range(9)],
        events=[{"interval": 2, "event": "chargers_fail", "value": 2}],
    )
    return account_of(scenario)
