"""The tables of a day explained, written into a run folder where asked for."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from evdash.explain.binding import Binding
from evdash.explain.refusals import Explanation
from evdash.explain.revisions import Revision
from evdash.explain.worth import Worth
from evdash.files.explanation_rows import BindingRow, ExplanationRow, RevisionRow, WorthRow
from evdash.files.run_tables import table_text


@dataclass(frozen=True, slots=True)
class DayExplained:
    """Every refusal, what more of each limit is worth, what binds when, every plan revised."""

    refusals: tuple[Explanation, ...]
    worths: tuple[Worth, ...]
    bindings: tuple[Binding, ...]
    revisions: tuple[Revision, ...]


def explanation_files(day: DayExplained) -> Mapping[str, str]:
    """The tables by name of file."""
    return {
        "explanations.csv": table_text(ExplanationRow, (_refusal(r) for r in day.refusals)),
        "worths.csv": table_text(WorthRow, (_worth(worth) for worth in day.worths)),
        "binding.csv": table_text(BindingRow, _bindings(day.bindings)),
        "revisions.csv": table_text(RevisionRow, (_revision(r) for r in day.revisions)),
    }


def _refusal(told: Explanation) -> ExplanationRow:
    return ExplanationRow.model_construct(
        vehicle=told.vehicle, cause=told.cause.kind, detail=told.detail, remedy=told.remedy
    )


def _worth(worth: Worth) -> WorthRow:
    return WorthRow.model_construct(
        change=worth.what,
        profit=worth.profit,
        admitted=worth.admitted,
        energy_kwh=worth.energy_kwh,
    )


def _bindings(bindings: Iterable[Binding]) -> Iterable[BindingRow]:
    for binding in bindings:
        for interval in sorted({*binding.tightest, *binding.reached}):
            yield BindingRow.model_construct(
                element=binding.element,
                interval=interval,
                tightest=int(interval in binding.tightest),
                reached=int(interval in binding.reached),
            )


def _revision(revision: Revision) -> RevisionRow:
    return RevisionRow.model_construct(
        interval=revision.interval,
        moved_kwh=revision.moved_kwh,
        for_newcomers_kwh=revision.for_newcomers_kwh,
        cost_change=revision.cost_change,
        told=revision.text,
    )
