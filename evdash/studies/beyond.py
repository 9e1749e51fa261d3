"""On how many days of a study charging was beyond limits, or promises were broken.

Told beside whatever a study found: a profit that takes the feeder beyond its limits is not to be
read as one within them.
"""

from evdash.domain.study import Run
from evdash.domain.words import counted
from evdash.studies.tables import Found

WITHIN_KEPT = "limits_broken"
BEYOND = (
    ("ac_limits_broken", "charging exceeds limits by AC power flow"),
    (WITHIN_KEPT, "charging exceeds limits in the linearised model, in which they are kept,"),
    ("broken", "promises are broken"),
)
"""What is counted day by day, and what it means where it is not zero."""


def beyond_told(found: Found, group: tuple[object, ...] | None = None) -> str:
    """A clause for each kind: on how many days; of one group of runs (its cells), or of all.

    Empty where no day that was run is beyond anything.
    """
    runs = [
        run
        for one, mine in found.groups().items()
        if group is None or one.cells == group
        for run in mine
    ]
    told = []
    for metric, does in BEYOND:
        days = [value for run in runs if (value := _value(found, run, metric)) is not None]
        beyond = sum(value > 0 for value in days)
        if beyond:
            told.append(f"{does} on {beyond:,} of {counted(len(days), 'day')}")
    return "; ".join(told)


def _value(found: Found, run: Run, metric: str) -> float | None:
    """A figure of a day; limits kept in AC are told as those of AC already."""
    return None if metric == WITHIN_KEPT and run.network == "ac" else found.value(run, metric)
