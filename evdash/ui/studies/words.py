"""What the Studies page says in words."""

from evdash.domain.study import Band
from evdash.studies.beyond import beyond_told
from evdash.studies.measures import MEASURES
from evdash.studies.tables import Found
from evdash.ui.words import plain

MINUTE, HOUR = 60.0, 3600.0
LESS_IS_BETTER = ("energy_cost", "refused", "broken", "limits_broken", "churn_kwh")


def duration(seconds: float) -> str:
    """A time span as a person says it."""
    if seconds < MINUTE:
        return f"{max(1, round(seconds))} s"
    if seconds < HOUR:
        minutes = round(seconds / MINUTE)
        return f"{minutes} minute{'s' if minutes > 1 else ''}"
    return f"{seconds / HOUR:.1f} hours"


def is_less_better(metric: str) -> bool:
    """Whether a low value is the good one."""
    return metric in LESS_IS_BETTER or metric.startswith("ac_")


def answer(found: Found, rows: list[Band], metric: str) -> str:
    """The best combination in a sentence; nothing where there is nothing to choose from."""
    mine = [band for band in rows if band.metric == metric]
    if len(mine) < 2:
        return ""
    sign = 1 if is_less_better(metric) else -1
    best = min(mine, key=lambda band: sign * band.p50)
    measure = MEASURES[metric]
    if max(band.p50 for band in mine) - min(band.p50 for band in mine) < 10.0**-measure.digits / 2:
        return f"{measure.title} is the same everywhere: {told(best)}.{everywhere(found)}"
    names = (*found.runs.axes, "policy", "network")
    varied = [i for i in range(len(names)) if len({band.group[i] for band in mine}) > 1]
    where = ", ".join(
        f"{plain(names[i])} **{plain(f'{best.group[i]}')}**"
        + edge(best.group[i], {band.group[i] for band in mine})
        for i in varied
    )
    word = "lowest" if is_less_better(metric) else "highest"
    said = f"{measure.title} is {word} at {where}: **{told(best)}**{spread(best)}."
    beyond = beyond_told(found, best.group)
    return f"{said} :red[:material/warning: There, {beyond}.]" if beyond else said


def everywhere(found: Found) -> str:
    """On how many days of all charging is beyond limits, or promises are broken."""
    beyond = beyond_told(found)
    return f" :red[:material/warning: Over all, {beyond}.]" if beyond else ""


def edge(best: object, tried: set[object]) -> str:
    """Whether the best may lie beyond what was tried: of numbers, the least or the most of them."""
    numbers = [value for value in tried if isinstance(value, int | float)]
    if len(numbers) < max(2, len(tried)):
        return ""
    if best == max(numbers):
        return " (the most tried)"
    return " (the least tried)" if best == min(numbers) else ""


def told(band: Band) -> str:
    """A median with its unit."""
    measure = MEASURES[band.metric]
    value = measure.told(band.p50)
    return f"\\${value}" if measure.unit == "$" else f"{value} {measure.unit}".strip()


def spread(band: Band) -> str:
    """What lies between 5 and 95 % of days."""
    tell = MEASURES[band.metric].told
    if band.days < 2 or band.p05 == band.p95:
        return ""
    return f" (5 to 95 % of days: {tell(band.p05)} to {tell(band.p95)})"
