"""`audit`: a run's files checked again by other means."""

import argparse

from evdash.audit.audit import Audit, audit_run
from evdash.audit.coverage import MEANING, told_of
from evdash.audit.objective import solves_p1
from evdash.audit.record import RunRecord
from evdash.cli.optimum import Proofs, prove
from evdash.cli.report import SENTENCE_STYLE
from evdash.cli.terminal import Terminal
from evdash.domain.words import element_name
from evdash.explain.words import Clock
from evdash.metrics.verdict import FULL_AC, LINEARISED, verdict_of
from evdash.metrics.verdict_words import MODEL, Wording, sentences

SHOWN = 40
BROKEN = 3


def audit(options: argparse.Namespace) -> int:
    """Audit a run folder; 3 if anything in it is broken or untrue, 0 otherwise."""
    result = audit_run(options.directory)
    proofs = _proofs(result.run) if options.optimum else None
    findings = (*result.findings, *(proofs.findings if proofs else ()))
    terminal = Terminal()
    for finding in findings[:SHOWN]:
        terminal.say("  ", ("✗", "red"), f" {finding}")
    _say_more(terminal, len(findings))
    _say_feeder(terminal, result)
    if findings:
        terminal.say((f"{len(findings)} findings", "bold red"))
    else:
        _say_sound(terminal, result.run)
    if options.optimum:
        _say_proofs(terminal, result.run, proofs)
    for standing in ("held", "on trust"):
        terminal.say(f"{MEANING[standing]}: {told_of(result.run.files, standing)}")
    return BROKEN if findings else 0


def _proofs(run: RunRecord) -> Proofs | None:
    """P1's optima; None where the run's policy does not solve P1 or its intervals are not whole."""
    whole = [row.interval for row in run.intervals] == list(range(run.scenario.intervals))
    return prove(run) if solves_p1(run) and whole else None


def _say_more(terminal: Terminal, count: int) -> None:
    if count > SHOWN:
        terminal.say(f"    and {count - SHOWN} more")


def _say_feeder(terminal: Terminal, result: Audit) -> None:
    """Limits exceeded in AC, and by the feeder itself in the linearised model."""
    run = result.run
    wording = Wording(lambda one: element_name(one.element), Clock(run.scenario, 0).at)
    judged = len(run.intervals)
    models = (
        verdict_of(LINEARISED, result.feeder_own, judged),
        verdict_of(FULL_AC, result.ac, judged),
    )
    for one in sentences(models, wording):
        if one.state in ("bad", "note"):
            terminal.say((one.head, SENTENCE_STYLE[one.state]), f": {one.details}")


def _say_sound(terminal: Terminal, run: RunRecord) -> None:
    statuses = [row.status for row in run.vehicles]
    released = statuses.count("released")
    given_up = f", {released} of them but for what drivers gave up" if released else ""
    terminal.say(
        ("ok", "bold green"),
        f" {run.scenario.name}: {len(statuses) - statuses.count('refused')} contracts kept"
        f"{given_up}, no limit of the chargers exceeded and none of the feeder by charging "
        f"{MODEL[run.network]}; {len(run.intervals)} intervals, {len(run.voltages)} voltages and "
        "all totals worked out again",
    )


def _say_proofs(terminal: Terminal, run: RunRecord, proofs: Proofs | None) -> None:
    if proofs is None:
        terminal.say("--optimum: nothing to prove, as the policy does not solve P1")
        return
    terminal.say(
        f"P1's optimum proven anew, to the cent, in {proofs.proven} of {len(run.intervals)} "
        "intervals; objective, bound and status held against it"
    )
    for told in proofs.open[:SHOWN]:
        terminal.say(f"  not proven: {told}")
    _say_more(terminal, len(proofs.open))
