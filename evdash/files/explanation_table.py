"""The table of refusals explained, written into a run folder where asked for."""

from collections.abc import Iterable

from evdash.domain.fields import Record, declare
from evdash.explain.refusals import Explanation
from evdash.files.run_tables import table_text

EXPLANATIONS = "explanations.csv"


class ExplanationRow(Record):
    """A row of `explanations.csv`: why a vehicle was refused and what would have admitted it."""

    vehicle: str = declare("Name of the vehicle", "", "PEV-001")
    cause: str = declare("What refused it, in a word or two", "", "headroom")
    detail: str = declare("Why it was refused, in a sentence", "", "")
    remedy: str = declare("What would have admitted it, in a sentence", "", "")


def explanations_text(explanations: Iterable[Explanation]) -> str:
    """`explanations.csv`, one row for each refused vehicle."""
    return table_text(
        ExplanationRow,
        (
            ExplanationRow.model_construct(
                vehicle=explained.vehicle,
                cause=explained.cause.kind,
                detail=explained.detail,
                remedy=explained.remedy,
            )
            for explained in explanations
        ),
    )
