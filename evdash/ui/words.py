"""What a run says in plain words. Text for Streamlit's Markdown; user text is escaped."""

import math
import re
import string
from collections import defaultdict
from collections.abc import Mapping, Sequence
from datetime import datetime

from evdash.domain import words
from evdash.domain.elements import Element
from evdash.domain.outlook import Outlook
from evdash.domain.plan import SolveReport
from evdash.domain.scenario import Scenario
from evdash.domain.trace import PAPERS, Step, Trace
from evdash.domain.words import counted as counted  # noqa: PLC0414 - ours, too
from evdash.metrics.verdict_words import Sentence, State, Wording
from evdash.policies.registry import described

_PUNCTUATION = re.compile(f"([{re.escape(string.punctuation)}])")
_TURNED = re.compile(r":(?=//|[\w+/-]+:)|@|www(?=\.)|[-<>~=](?=[->=])", re.IGNORECASE)
"""After what Streamlit's Markdown would turn into something else."""
JOINER = "\u2060"
_UNFIT = re.compile(r"[^a-z0-9]+")
MOST_REASONS = 3
"""So many reasons are told in words; the table has them all."""


def plain(text: str) -> str:
    """User text as Markdown shows it unchanged: no formatting, no links, no formulas.

    Escapes alone will not do: addresses, emoji, icons and arrows are found in what is left when
    escapes have been read, so an invisible joiner parts them. It is one line, too, since
    paragraphs and code begin with new ones.
    """
    return _PUNCTUATION.sub(r"\\\1", _TURNED.sub(rf"\g<0>{JOINER}", " ".join(text.split())))


def file_stem(name: str) -> str:
    """What a file made of something named by the user is called, without its ending."""
    return _UNFIT.sub("-", name.lower()).strip("-")[:40] or "scenario"


def money(usd: float) -> str:
    """An amount, `$1,234.50`; the dollar sign escaped, or Markdown would set a formula."""
    return words.money(usd).replace("$", "\\$")


def clock(moment: datetime, outlook: Outlook) -> str:
    """A clock time, with the date where the day crosses midnight."""
    return moment.strftime("%H:%M, %d %b" if outlook.crosses_midnight else "%H:%M")


def markdown_table(rows: Sequence[Mapping[str, object]]) -> str:
    """Rows as a Markdown table, numbers to the right; user text in it is escaped."""
    if not rows:
        return ""
    numeric = {name for name, value in rows[0].items() if isinstance(value, int | float)}
    lines = [
        "| " + " | ".join(plain(name) for name in rows[0]) + " |",
        "|" + "|".join("--:" if name in numeric else ":--" for name in rows[0]) + "|",
    ]
    for row in rows:
        cells = ("" if value is None else plain(f"{value}") for value in row.values())
        lines.append("| " + " | ".join(cells) + " |")
    return "\n".join(lines)


def element_words(element: Element | None, scenario: Scenario) -> str:
    """A binding element as a person would name it."""
    return words.element_words(element, scenario, plain)


def decision_title(step: Step, outlook: Outlook) -> str:
    """Which interval was decided."""
    begin, end = outlook.times[step.interval], outlook.times[step.interval + 1]
    return f"Decided for {begin:%H:%M}–{end:%H:%M}"


def decision_lines(step: Step, outlook: Outlook) -> list[str]:
    """What the optimiser decided in a step: who, why not, what limits, how sure it is."""
    plan = step.plan
    asked = len(step.requests)
    if not asked:
        lines = ["Nobody asked for a charge."]
    else:
        lines = [
            f"**{counted(asked, 'vehicle')} asked:** {len(plan.admitted)} admitted, "
            f"{len(plan.refused)} refused."
        ]
    reasons = sorted(_by_reason(step).items(), key=lambda item: -len(item[1]))
    for reason, vehicles in reasons[:MOST_REASONS]:
        lines.append(f"Refused, {plain(reason)}: {_listed(vehicles)}.")
    if len(reasons) > MOST_REASONS:
        lines.append("For the other refusals see the table.")
    lines.append(
        f"**{int(plan.charging[0])} charging** with {step.station_kw:,.1f}\u00a0kW in all"
        + _of_headroom(step, outlook)
    )
    lines.append(quality(plan.report))
    return lines


def _by_reason(step: Step) -> dict[str, list[str]]:
    """Who was refused, by the kind of reason."""
    reasons: dict[str, list[str]] = defaultdict(list)
    for refusal in step.plan.refused:
        reasons[refusal.reason.clause].append(refusal.vehicle)
    return reasons


def _listed(vehicles: list[str], most: int = 5) -> str:
    named = ", ".join(plain(vehicle) for vehicle in vehicles[:most])
    rest = len(vehicles) - most
    return f"{named} and {rest} more" if rest > 0 else named


def _of_headroom(step: Step, outlook: Outlook) -> str:
    headroom = outlook.headroom_kw[step.interval]
    if not math.isfinite(headroom):
        return "; the feeder sets no limit."
    element = element_words(outlook.binding[step.interval], step.inputs.scenario)
    return f"; the feeder leaves room for {headroom:,.0f}\u00a0kW, limited by {element}."


def decided_by(policy: str) -> str:
    """Who decides, where that is not the paper's P1; else nothing."""
    return "" if policy == PAPERS else f"decided by {plain(described(policy).title)}"


def quality(report: SolveReport) -> str:
    """How good the plan is known to be, in plain words."""
    if report.status == "fallback":
        why = f" ({plain(report.note)})" if report.note else ""
        return (
            f":orange[Kept the previous plan] and admitted nobody new: there was none in time that "
            f"passes every check{why}. Every contract stands."
        )
    seconds = f"{report.seconds:.2f} s" if report.seconds >= 0.005 else "a few milliseconds"
    if report.objective is None:
        return f"Decided in {seconds}."
    if report.bound is None:
        return f"A plan that keeps every promise; how far from the best is not proven. {seconds}."
    gap_usd = max(0.0, report.objective - report.bound)
    if report.status == "optimal":
        return f"**Proven optimal to within 1 cent**; found in {seconds}."
    return f"**At most {money(gap_usd)} from the best possible**; stopped after {seconds}."


def wording(trace: Trace, outlook: Outlook) -> Wording:
    """How sentences of a verdict call limits and times on a page."""
    return Wording.of(trace, lambda t: clock(outlook.times[t], outlook), plain)


def marked(sentence: Sentence) -> str:
    """A sentence of a verdict with its colour and sign, its first part in bold."""
    details = f": {sentence.details}" if sentence.details else ""
    colour, icon = MARKS[sentence.state]
    told = f":material/{icon}: **{sentence.head}**{details}."
    return f":{colour}[{told}]" if colour else told


MARKS: Mapping[State, tuple[str, str]] = {
    "bad": ("red", "warning"),
    "note": ("orange", "info"),
    "good": ("green", "check_circle"),
    "open": ("", "hourglass_top"),
}
