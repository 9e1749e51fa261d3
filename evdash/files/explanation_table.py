"""The tables of a day explained, written into a run folder where asked for."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from evdash.domain.fields import Record, declare
from evdash.explain.binding import Binding
from evdash.explain.refusals import Explanation
from evdash.explain.revisions import Revision
from evdash.explain.worth import Worth
from evdash.files.run_tables import table_text


@dataclass(frozen=True, slots=True)
class DayExplained:
    """Every refusal, what more of each limit is worth, what binds when, every plan revised."""

    refusals: tuple[Explanation, ...]
    worths: tuple[Worth, ...]
    bindings: tuple[Binding, ...]
    revisions: tuple[Revision, ...]


class ExplanationRow(Record):
    """A row of `explanations.csv`: why a vehicle was refused and what would have admitted it."""

    vehicle: str = declare("Name of the vehicle", "", "PEV-001")
    cause: str = declare("What refused it, in a word or two", "", "headroom")
    detail: str = declare("Why it was refused, in a sentence", "", "")
    remedy: str = declare("What would have admitted it, in a sentence", "", "")


class WorthRow(Record):
    """A row of `worths.csv`: one limit raised, and by how much the day's totals move."""

    change: str = declare("What there is more of", "", "One more charger")
    profit: float = declare("Profit more, or less", "$", 0.0)
    admitted: int = declare("Vehicles more, or fewer", "vehicles", 0)
    energy_kwh: float = declare("Energy delivered more, or less", "kWh", 0.0)


class BindingRow(Record):
    """A row of `binding.csv`: an element in an interval in which it is tightest or reached."""

    element: str = declare("The element, or `chargers`", "", "line:633-634")
    interval: int = declare("Interval", "", 0, ge=0)
    tightest: int = declare("1 where it sets the headroom", "", 0, ge=0)
    reached: int = declare("1 where all that it leaves is used", "", 0, ge=0)


class RevisionRow(Record):
    """A row of `revisions.csv`: what an interval's decision changed in the plan before it."""

    interval: int = declare("Interval", "", 1, ge=1)
    moved_kwh: float = declare("Energy that changed its interval", "kWh", 0.0, ge=0)
    for_newcomers_kwh: float = declare("Of that, to make room for newcomers", "kWh", 0.0, ge=0)
    cost_change: float = declare("Change of the energy cost", "$", 0.0)
    told: str = declare("What changed and why, in sentences", "", "")


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
