"""One run of a day as the app holds it: immutable, replaced whole. No Streamlit in here."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from evdash.domain.plan import Policy
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.errors import Fault, ImpossibleCommitments, InputError, Shortfall, SolverFailure
from evdash.files.overrides import edit_scenario
from evdash.horizon.day import start_day, step
from evdash.horizon.happen import undone
from evdash.horizon.revise import revise


@dataclass(frozen=True, slots=True)
class Answer:
    """What the app has to say about the last edit; at most one of the two is not empty.

    `shortfalls`: applied, it would have broken these contracts. `faults`: it was not valid.
    """

    title: str
    shortfalls: tuple[Shortfall, ...] = ()
    faults: tuple[Fault, ...] = ()


@dataclass(frozen=True, slots=True)
class Run:
    """A scenario as it was opened, the day so far, and the answer to the last edit.

    `folder` is the bundled scenario's; None for a scenario of the user's own.
    """

    folder: Path | None
    opened: Scenario
    trace: Trace
    answer: Answer | None = None


def open_run(folder: Path | None, scenario: Scenario) -> Run:
    """A scenario at the start of its day."""
    return Run(folder, scenario, start_day(scenario))


def stepped(run: Run, policy: Policy) -> Run:
    """One interval further; the same run once the day is over."""
    if run.trace.is_over:
        return run
    return replace(run, trace=step(run.trace, policy), answer=None)


def stepped_back(run: Run) -> Run:
    """Before the last step, with the inputs it was decided under; later edits are undone."""
    if not run.trace.steps:
        return run
    return replace(run, trace=undone(run.trace), answer=None)


def restarted(run: Run) -> Run:
    """The start of the day, with the settings now in force."""
    return replace(run, trace=start_day(run.trace.scenario, run.trace.inputs.network), answer=None)


def restored(run: Run) -> Run:
    """The settings the scenario was opened with, from now on."""
    return _revised(run, run.opened, "the preset's settings")


def rewired(run: Run, network: Network) -> Run:
    """The limits of another network model in force from now on."""
    return _revised(run, run.trace.scenario, "another network model", network)


def edited(
    run: Run,
    title: str,
    settings: Mapping[str, object],
    price_per_kwh: tuple[float, ...] | None = None,
) -> Run:
    """Some keys of the scenario, or its energy prices, changed from now on.

    What is not valid, or would break a contract, changes nothing but the answer, which
    calls the edit by its `title`.
    """
    try:
        scenario = edit_scenario(run.trace.scenario, settings, price_per_kwh)
    except InputError as error:
        return replace(run, answer=Answer(f"Not applied: {title}", faults=error.faults))
    return _revised(run, scenario, title)


def _revised(run: Run, scenario: Scenario, title: str, network: Network | None = None) -> Run:
    try:
        trace = revise(run.trace, scenario, network)
    except ImpossibleCommitments as error:
        answer = Answer(f"Not applied: {title}", shortfalls=error.shortfalls)
    except SolverFailure as error:
        unsure = Fault("optimiser", str(error), "contracts could not be shown to be safe")
        answer = Answer(f"Not applied: {title}", faults=(unsure,))
    else:
        return replace(run, trace=trace, answer=None)
    return replace(run, answer=answer)
