"""One run of a study, as a worker does it: plain data in, plain data out."""

import signal
import sys
import time
from dataclasses import dataclass
from functools import lru_cache

from threadpoolctl import ThreadpoolController

from evdash.domain.plan import is_outside
from evdash.domain.scenario import Scenario
from evdash.domain.study import Result
from evdash.domain.trace import Inputs, Network
from evdash.errors import EvdashError
from evdash.grid.acmany import ManyDays
from evdash.horizon.day import begin, run_day
from evdash.horizon.inputs import prepare, prepare_like
from evdash.policies.registry import given
from evdash.studies.code import code_of
from evdash.studies.days import with_seed
from evdash.studies.measures import Day, figures


class OtherCode(EvdashError):
    """A worker runs other code than the study was begun with, so its results would not fit."""


@dataclass(frozen=True, slots=True)
class Task:
    """A run to be done. `scenario` is JSON; `code` the version of the code that asks.

    `folder` is where it does: a worker begun earlier may be elsewhere, and has to find a policy
    of one's own.
    """

    key: str
    scenario: str
    seed: int | None
    policy: str
    network: Network
    referee: bool
    code: str
    folder: str = ""


@dataclass(frozen=True, slots=True)
class Prepared:
    """What all days of one point share: its scenario, the rows of its feeder, the feeder in AC."""

    inputs: Inputs
    feeder: ManyDays


def work(task: Task) -> Result:
    """Do a run; whatever goes wrong is its result. Raises OtherCode."""
    if task.folder and is_outside(task.policy) and task.folder not in sys.path:
        sys.path.insert(0, task.folder)
    if task.code != code_of(task.policy):
        raise OtherCode(
            "a worker runs another version of evdash, of a package beneath or of the policy; start "
            "it from the same folder and environment"
        )
    began = time.process_time()
    try:
        with _threads().limit(limits=1):  # sums come out the same only on one thread
            found = figures(_day(task))
    except Exception as error:  # noqa: BLE001 - a run that fails must not end the study
        kind = "" if isinstance(error, EvdashError) else f"{type(error).__name__}: "
        reason = f"{kind}{error}" or type(error).__name__
        return Result(task.key, "failed", reason, {}, time.process_time() - began)
    return Result(task.key, "done", "", found, time.process_time() - began)


def _day(task: Task) -> Day:
    prepared = _prepared(task.scenario, task.network)
    scenario = prepared.inputs.given
    if task.seed is not None:
        scenario = with_seed(scenario, task.seed)
    inputs = prepare_like(scenario, prepared.inputs)
    rule = given(task.policy)  # a study was laid out with it: it is known, or was given by hand
    trace = run_day(begin(inputs, rule.name), rule.make(inputs), decide=rule.decide)
    # the loads of the whole day as they turned out decide its power flow
    feeder = ManyDays(trace.scenario) if trace.happenings else prepared.feeder
    return Day(trace, feeder, task.referee)


@lru_cache(maxsize=4)
def _prepared(scenario: str, network: Network) -> Prepared:
    read = Scenario.model_validate_json(scenario)
    return Prepared(prepare(read, network), ManyDays(read))


@lru_cache(maxsize=1)
def _threads() -> ThreadpoolController:
    return ThreadpoolController()


def leave_interrupts() -> None:
    """Have Ctrl-C reach only who asked for the work: a worker goes when that one lets it go."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
