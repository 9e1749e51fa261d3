"""evdash as a library: what `import evdash` offers, a thin face on everything beneath."""

from evdash.api.comparisons import Comparison, compare
from evdash.api.days import Day
from evdash.api.races import Race
from evdash.api.scenarios import Scenario, load
from evdash.api.studies import Study, study
from evdash.errors import EvdashError, InputError

__all__ = [
    "Comparison",
    "Day",
    "EvdashError",
    "InputError",
    "Race",
    "Scenario",
    "Study",
    "compare",
    "load",
    "study",
]
