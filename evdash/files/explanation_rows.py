"""The tables of a day explained, each column declared once for writing, reading and the docs."""

from collections.abc import Mapping

from evdash.domain.fields import Record, declare


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


EXPLANATION_TABLES: Mapping[str, type[Record]] = {
    "explanations.csv": ExplanationRow,
    "worths.csv": WorthRow,
    "binding.csv": BindingRow,
    "revisions.csv": RevisionRow,
}
