"""One run of a day as the app holds it: immutable, replaced whole. No Streamlit in here."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from evdash.domain.arrivals import Arrival
from evdash.domain.events import Event
from evdash.domain.plan import Policy
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Network, Trace
from evdash.errors import (
    EvdashError,
    Fault,
    ImpossibleCommitments,
    InputError,
    Shortfall,
    SolverFailure,
)
from evdash.files.overrides import edit_scenario
from evdash.horizon.day import Decide, start_day, step
from evdash.horizon.guests import joined
from evdash.horizon.happen import happen, undone
from evdash.horizon.in_force import in_force
from evdash.horizon.revise import put_in_force, revise
from evdash.policies.registry import described
from evdash.ui.edits import CHARGERS, edit_of, with_settings_kept
from evdash.ui.solving import decider
from evdash.ui.words import plain


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


def stepped(run: Run, policy: Policy, decide: Decide | None = None) -> Run:
    """One interval further; the same run once the day is over."""
    if run.trace.is_over:
        return run
    return replace(run, trace=step(run.trace, policy, decide=decide), answer=None)


def decided(run: Run) -> Run:
    """One interval further, by whoever decides the day; or the same with what keeps them from it.

    That is so of a run brought back where a policy is not installed any more.
    """
    try:
        policy, decide = decider(run.trace)
    except (InputError, SolverFailure) as error:
        return replace(run, answer=_unable(f"Not decided by {_title(run.trace.policy)}", error))
    return stepped(run, policy, decide)


def handed_to(run: Run, policy: str) -> Run:
    """The day for another policy to decide, from its start and with the settings now in force.

    A day decided in part by one and in part by another would be nobody's to report or explain.
    """
    if policy == run.trace.policy:
        return run
    trace = run.trace if not run.trace.steps else restarted(run).trace
    trace = replace(trace, policy=policy)
    try:
        decider(trace)
    except (InputError, SolverFailure) as error:
        return replace(run, answer=_unable(f"Not handed to {_title(policy)}", error))
    return replace(run, trace=trace, answer=None)


def stepped_back(run: Run) -> Run:
    """Before the last step, with the inputs it was decided under; later edits are undone."""
    if not run.trace.steps:
        return run
    return replace(run, trace=undone(run.trace), answer=None)


def restarted(run: Run, network: Network | None = None) -> Run:
    """The start of the day, with the settings now in force; what happened is forgotten.

    Limits are kept in `network`, by default in the model they are kept in now.
    """
    trace = run.trace
    scenario = with_settings_kept(trace, run.opened)
    begun = start_day(scenario, network or trace.inputs.network, trace.policy)
    return replace(run, trace=begun, answer=None)


def restored(run: Run) -> Run:
    """The settings the scenario was opened with, from now on; what happened stays happened.

    Once the day is over, as with every edit, that is for its next run.
    """
    trace, title = run.trace, "the preset's settings"
    if not trace.steps or trace.is_over:
        return _revised(run, run.opened, title)
    happened = tuple(e for e in trace.inputs.given.events if e not in run.opened.events)
    scenario = run.opened.replacing(events=(*run.opened.events, *happened))
    before = in_force(run.opened, trace.now)
    chargers = {CHARGERS: before.station.chargers}
    there = _revised(run, scenario, title)
    edit = edit_of(there.trace, chargers, tuple(before.price_per_kwh.tolist()))
    return there if there.answer else _happened(run, there, title, edit.events)


def rewired(run: Run, network: Network) -> Run:
    """The limits of another network model in force from now on."""
    return _revised(run, run.trace.inputs.given, "another network model", network)


def edited(
    run: Run,
    title: str,
    settings: Mapping[str, object],
    price_per_kwh: tuple[float, ...] | None = None,
) -> Run:
    """Some keys of the scenario, or its energy prices, changed from now on.

    In mid-day chargers and prices change by events, so that the day can be run again. What is
    not valid, or would break a contract, changes nothing but the answer, which calls the edit
    by its `title`.
    """
    trace = run.trace
    under_way = bool(trace.steps) and not trace.is_over
    given = with_settings_kept(trace, run.opened) if trace.is_over else trace.inputs.given
    try:
        if not under_way:
            return _revised(run, edit_scenario(given, settings, price_per_kwh), title)
        edit_scenario(trace.scenario, settings, price_per_kwh)  # tells every fault there is
        edit = edit_of(trace, settings, price_per_kwh)
        scenario = edit_scenario(given, edit.settings)
    except InputError as error:
        return replace(run, answer=Answer(f"Not applied: {title}", faults=error.faults))
    there = _revised(run, scenario, title) if edit.settings else run
    return there if there.answer else _happened(run, there, title, edit.events)


def happened(run: Run, event: Event, before: Trace, after: Trace) -> Run:
    """The run after an event, whatever it breaks; `after` is what it makes of `before`."""
    if event.interval != run.trace.now or run.trace.is_over:
        return run
    trace = after if run.trace is before else happen(run.trace, [event])
    return replace(run, trace=trace, answer=None)


def foreseen(run: Run, title: str, event: Event) -> Run:
    """An event that is to happen later in the day, or now; what it breaks, it breaks."""
    trace = run.trace
    if trace.steps and event.interval == trace.now:
        return replace(run, trace=happen(trace, (event,)), answer=None)
    given = trace.inputs.given
    return _revised(run, given.replacing(events=(*given.events, event)), title)


def visited(run: Run, guest: Arrival) -> Run:
    """One more vehicle comes now."""
    try:
        return replace(run, trace=joined(run.trace, guest), answer=None)
    except InputError as error:
        return replace(run, answer=Answer("Nobody was added", faults=error.faults))


def _happened(run: Run, there: Run, title: str, events: tuple[Event, ...]) -> Run:
    """`there` after events, or `run` with an answer where they would break a promise."""
    if not events:
        return replace(there, answer=None)
    trace = happen(there.trace, events)
    short = tuple(
        Shortfall(one.vehicle, one.short_kwh)
        for one in trace.happenings[-1].revisions
        if one.short_kwh > 0
    )
    if short:
        return replace(run, answer=Answer(f"Not applied: {title}", shortfalls=short))
    return replace(there, trace=trace, answer=None)


def _title(policy: str) -> str:
    return plain(described(policy).title)


def _unable(title: str, error: EvdashError) -> Answer:
    """What to say where a policy cannot decide a day."""
    if isinstance(error, InputError):
        return Answer(title, faults=error.faults)
    return Answer(title, faults=(Fault("policy", f"{error}", "should find a plan"),))


def _revised(run: Run, scenario: Scenario, title: str, network: Network | None = None) -> Run:
    change = revise if described(run.trace.policy).keeps_limits else put_in_force
    try:
        trace = change(run.trace, scenario, network)
    except ImpossibleCommitments as error:
        answer = Answer(f"Not applied: {title}", shortfalls=error.shortfalls)
    except SolverFailure as error:
        unsure = Fault("optimiser", str(error), "contracts could not be shown to be safe")
        answer = Answer(f"Not applied: {title}", faults=(unsure,))
    else:
        return replace(run, trace=trace, answer=None)
    return replace(run, answer=answer)
