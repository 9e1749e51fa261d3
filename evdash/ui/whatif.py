"""A teacher's prompts: what is changed from now on, and what that does to the whole day.

No Streamlit in here.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.events import Event
from evdash.domain.words import money
from evdash.explain.words import Clock
from evdash.metrics.service import Totals, totals
from evdash.ui import run as runs
from evdash.ui.run import Run
from evdash.ui.solving import whole_day
from evdash.ui.words import counted, plain

FEWER_CHARGERS = 2
FAILURE_HOUR = 18
PEAK_SHARE = 0.95
"""Prices within so much of the highest to come count as the peak."""

FOR_NEXT_RUN = "in force when the day is run again; Reset, and step, to see it hour by hour"


@dataclass(frozen=True, slots=True)
class Prompt:
    """A question of the kind "what if …", and the change that answers it; None: not now."""

    key: str
    label: str
    help: str
    change: Callable[[Run], Run] | None


@dataclass(frozen=True, eq=False)
class Prompted:
    """A prompt that was pressed: the run before it and the run with it."""

    label: str
    before: Run
    after: Run

    @property
    def is_for_next_run(self) -> bool:
        """Whether the day was over when it was pressed."""
        return self.before.trace.is_over

    def told(self, run: Run) -> str:
        """What the table of effects is about, as Markdown, seen from the run as it is by now."""
        name = f"**{plain(self.label)}"
        if run.trace is self.after.trace:
            when = FOR_NEXT_RUN if self.is_for_next_run else "what it does to the day"
            return f"{name}:** {when}. Undo takes it back."
        trace = self.before.trace
        when = f"at {trace.scenario.time_of(trace.now):%H:%M}"
        when = "once the day was over" if self.is_for_next_run else when
        return f"{name}**, pressed {when}: what it does to the day if nothing else is changed."

    @cached_property
    def effects(self) -> list[dict[str, str]]:
        """What it does by the end of the day, before and after, as rows of a table."""
        after = runs.restarted(self.after) if self.is_for_next_run else self.after
        return [
            {"By the end of the day": name}
            | {figure: told(day) for figure, told in FIGURES.items()}
            for name, day in (
                ("Before", totals(whole_day(self.before.trace))),
                ("After", totals(whole_day(after.trace))),
            )
        ]


def prompts(run: Run) -> list[Prompt]:
    """All prompts for a run as it stands."""
    return [_dearer_peak(run), _fewer_chargers(run), _everyone_picks_first(run), _failure(run)]


def _dearer_peak(run: Run) -> Prompt:
    prices = run.trace.scenario.price_per_kwh
    first = 0 if run.trace.is_over else run.trace.now
    highest = float(prices[first:].max())
    peak = (np.arange(len(prices)) >= first) & (prices >= PEAK_SHARE * highest)
    doubled = tuple(np.where(peak, 2 * prices, prices).tolist())
    label = "Double the peak price"
    hours = Clock(run.trace.scenario, first).spans(np.flatnonzero(peak).tolist())
    return Prompt(
        "dearer_peak",
        label,
        f"Energy is dearest {hours}, up to {highest:.3g} \\$/kWh; it costs twice as much then."
        if highest > 0
        else "Not here: no energy price still to come is above 0.",
        (lambda run: runs.edited(run, label, {}, doubled)) if highest > 0 else None,
    )


def _fewer_chargers(run: Run) -> Prompt:
    left = run.trace.scenario.station.chargers - FEWER_CHARGERS
    label = f"Remove {counted(FEWER_CHARGERS, 'charger')}"
    return Prompt(
        "fewer_chargers",
        label,
        "From now on. Refused if a promise already made would be broken by it.",
        (lambda run: runs.edited(run, label, {"station.chargers": left})) if left >= 0 else None,
    )


def _everyone_picks_first(run: Run) -> Prompt:
    scenario = run.trace.scenario
    names = [option.name for option in scenario.option]
    label = f"Everyone picks {names[0]}"
    shares = {f"arrivals.option_share.{name}": float(name == names[0]) for name in names}
    drawn = isinstance(scenario.arrivals, GeneratedArrivals)
    return Prompt(
        "everyone_picks",
        label,
        "From now on every driver chooses the first price option."
        if drawn
        else "Not here: in this scenario every driver's choice is recorded.",
        (lambda run: runs.edited(run, plain(label), shares)) if drawn else None,
    )


def _failure(run: Run) -> Prompt:
    trace, label = run.trace, f"A charger fails at {FAILURE_HOUR}:00"
    hours = [
        t
        for t in range(trace.now, trace.scenario.intervals)
        if (moment := trace.scenario.time_of(t)).hour == FAILURE_HOUR and moment.minute == 0
    ]
    event = None
    if hours and trace.scenario.station.chargers:
        row = {"interval": hours[0], "event": "chargers_fail", "value": 1}
        event = Event.model_validate(row)
    return Prompt(
        "failure",
        label,
        "The station learns of it only then. Promises it can no longer keep are told.",
        None if event is None else lambda run: runs.foreseen(run, label, event),
    )


FIGURES: dict[str, Callable[[Totals], str]] = {
    "Admitted": lambda day: f"{day.admitted:,} of {day.arrived:,}",
    "Broken promises": lambda day: f"{day.broken:,}",
    "Delivered": lambda day: f"{day.energy_delivered_kwh:,.0f} kWh",
    "Highest station load": lambda day: f"{day.peak_station_kw:,.0f} kW",
    "Revenue": lambda day: money(day.revenue),
    "Energy cost": lambda day: money(day.energy_cost),
    "Profit": lambda day: money(day.profit),
}
