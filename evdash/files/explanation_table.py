"""The tables of a day explained, written into a run folder where asked for."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from evdash.domain.scenario import Scenario
from evdash.explain.binding import Binding
from evdash.explain.refusals import Explanation
from evdash.explain.revisions import Revision
from evdash.explain.worth import Worth
from evdash.files.explanation_rows import BindingRow, ExplanationRow, RevisionRow, WorthRow
from evdash.files.run_tables import table_text


@dataclass(frozen=True, slots=True)
class DayExplained:
    """Every refusal, what more of each limit is worth, what binds when, every plan revised."""

    scenario: Scenario
    refusals: tuple[Explanation, ...]
    worths: tuple[Worth, ...]
    bindings: tuple[Binding, ...]
    revisions: tuple[Revision, ...]


def explanation_files(day: DayExplained) -> Mapping[str, str]:
    """The tables by name of file."""
    return {
        "explanations.csv": table_text(ExplanationRow, map(refusal_row, day.refusals)),
        "worths.csv": table_text(WorthRow, map(worth_row, day.worths)),
        "binding.csv": table_text(BindingRow, binding_rows(day.scenario, day.bindings)),
        "revisions.csv": table_text(RevisionRow, map(revision_row, day.revisions)),
    }


def refusal_row(told: Explanation) -> ExplanationRow:
    """A row of `explanations.csv`."""
    return ExplanationRow.model_construct(
        vehicle=told.vehicle, cause=told.cause.kind, detail=told.detail, remedy=told.remedy
    )


def worth_row(worth: Worth) -> WorthRow:
    """A row of `worths.csv`."""
    return WorthRow.model_construct(
        change=worth.what,
        profit=worth.profit,
        admitted=worth.admitted,
        energy_kwh=worth.energy_kwh,
    )


def binding_rows(scenario: Scenario, bindings: Iterable[Binding]) -> Iterable[BindingRow]:
    """`binding.csv`: each element in every interval in which it is tightest or reached."""
    for binding in bindings:
        for interval in sorted({*binding.tightest, *binding.reached}):
            yield BindingRow.model_construct(
                element=scenario.file_name(binding.element),
                interval=interval,
                tightest=int(interval in binding.tightest),
                reached=int(interval in binding.reached),
            )


def revision_row(revision: Revision) -> RevisionRow:
    """A row of `revisions.csv`."""
    return RevisionRow.model_construct(
        interval=revision.interval,
        moved_kwh=revision.moved_kwh,
        for_newcomers_kwh=revision.for_newcomers_kwh,
        cost_change=revision.cost_change,
        told=revision.text,
    )
