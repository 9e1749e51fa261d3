"""The paper's scalability study: a hundred days of random arrivals, measured before and here."""

import statistics
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import streamlit as st

from evdash.charts.days import days_alt, days_figure
from evdash.charts.drawn import Drawn
from evdash.domain.arrivals import GeneratedArrivals
from evdash.domain.scenario import Scenario
from evdash.studies.days import DayTaken, days_taken
from evdash.studies.days_file import MeasuredDays, processor, read_days
from evdash.ui.apart import one_click
from evdash.ui.parts import show, table_below
from evdash.ui.session import Session
from evdash.ui.solving import study_policy
from evdash.ui.words import counted, markdown_table, plain

KEY = "evdash:study"
DAYS = 100


@dataclass(frozen=True, slots=True)
class Published:
    """The only figures the paper gives of its study (section IV), in s: range and median."""

    lowest: float = 12.7
    median: float = 16.8
    highest: float = 21.4


PUBLISHED = Published()
SAID = """\
> To analyze scalability, 100 instances of (P1) were solved for random arrival of PEVs over a
24 hr period. The total time for solving (P1) was found to be in the range [12.7, 21.4] sec with
median at 16.8 sec.

That was with YALMIP and Gurobi on a 2.7 GHz Intel Core i5 with 8 GB of memory. How many vehicles
came, and whether building the problem counts, is not said: a comparison of orders of magnitude,
not of machines or solvers.
"""


class Study:
    """The days a tab has run of one scenario, and whether it goes on."""

    def __init__(self, scenario: Scenario) -> None:
        self.scenario = scenario
        self.days: tuple[DayTaken, ...] = ()
        self.running = False

    @property
    def is_complete(self) -> bool:
        return len(self.days) >= DAYS


def current_study(session: Session) -> Study:
    """This tab's study of the scenario now in force; another scenario begins another study."""
    scenario = session.run.trace.scenario
    study: Study | None = st.session_state.get(KEY)
    if study is None or study.scenario != scenario:
        study = st.session_state[KEY] = Study(scenario)
    return study


@lru_cache(maxsize=1)
def before() -> MeasuredDays:
    """The days measured when the program was made."""
    return read_days()


def study(session: Session) -> None:
    """What the paper states, the days measured before, and as many as are run here."""
    ours = current_study(session)
    left, right = st.columns([3, 2], gap="medium")
    with left:
        st.markdown("#### A hundred days: how long solving takes")
        series = {"Measured": [day.seconds for day in before().days]}
        if ours.days:
            series["Here"] = [day.seconds for day in ours.days]
        published = (PUBLISHED.lowest, PUBLISHED.median, PUBLISHED.highest)
        chart = st.container()
        progress = st.container()
        _controls(ours)
    with right:
        st.markdown("**The paper says**")
        st.markdown(SAID)
    with chart:
        show(Drawn(days_figure(series, published)), "chart_study", days_alt(series))
        st.markdown(markdown_table(_rows(ours)))
        _where(ours)
        if ours.days:
            table_below("study", lambda: _days(ours))
    with progress:
        _run_on(ours)


def _controls(ours: Study) -> None:
    drawn = isinstance(ours.scenario.arrivals, GeneratedArrivals)
    label = "Run them here" if not ours.days else "Go on"
    st.button(
        "Cancel" if ours.running else label,
        on_click=one_click(_switch),
        args=(ours,),
        key="run_study",
        icon=":material/stop:" if ours.running else ":material/play_arrow:",
        disabled=not drawn or ours.is_complete,
        help=f"Runs {DAYS} days of the present scenario, with the seeds 1 to {DAYS}, on this "
        "computer. Others who use this server take turns with it; what is done stays when you "
        "cancel.",
    )
    if not drawn:
        st.caption("The vehicles of the present scenario come from a list: it has one day only.")


def _switch(ours: Study) -> None:
    ours.running = not ours.running


def _run_on(ours: Study) -> None:
    """Run the days still missing, telling how far it is; a click stops between two intervals."""
    if not ours.running:
        return
    done = len(ours.days)
    bar = st.progress(done / DAYS, f"Day {done + 1} of {DAYS} …")

    def tell() -> None:
        bar.progress(len(ours.days) / DAYS, f"Day {len(ours.days) + 1} of {DAYS} …")

    seeds = range(done + 1, DAYS + 1)
    for day in days_taken(ours.scenario, seeds, study_policy, tell):
        ours.days = (*ours.days, day)
    ours.running = False
    st.rerun()


def _rows(ours: Study) -> list[dict[str, object]]:
    rows: list[dict[str, object]] = [
        {
            "": "The paper",
            "days": "100",
            "fastest, s": f"{PUBLISHED.lowest:.1f}",
            "median, s": f"{PUBLISHED.median:.1f}",
            "slowest, s": f"{PUBLISHED.highest:.1f}",
            "slowest interval, s": "not told",
            "proven": "not told",
        }
    ]
    rows.append(_row("Measured", before().days))
    if ours.days:
        rows.append(_row("Here", ours.days))
    return rows


def _row(name: str, days: Sequence[DayTaken]) -> dict[str, object]:
    seconds = [day.seconds for day in days]
    proven = sum(day.proven for day in days) / sum(day.intervals for day in days)
    return {
        "": name,
        "days": f"{len(days)}",
        "fastest, s": f"{min(seconds):.2f}",
        "median, s": f"{statistics.median(seconds):.2f}",
        "slowest, s": f"{max(seconds):.2f}",
        "slowest interval, s": f"{max(day.slowest_seconds for day in days):.2f}",
        "proven": f"{100 * proven:.1f} % of intervals",
    }


def _where(ours: Study) -> None:
    made = before()
    machine, versions = made.machine, made.versions
    told = (
        f"**Measured** {made.made_on} with `{made.made_by}` on {plain(made.scenario)}: "
        f"{plain(machine['processor'])}, {machine['cores']} cores, {plain(machine['system'])}, "
        f"Python {versions['python']}, HiGHS {versions['highspy']}, NumPy {versions['numpy']}, "
        f"evdash {versions['evdash']}{f'; {plain(made.note)}' if made.note else ''}."
    )
    if ours.days:
        told += (
            f"  \n**Here**: {plain(ours.scenario.name)}, {counted(len(ours.days), 'day')}, on "
            f"{plain(processor())}."
        )
    st.caption(told + "  \nSolving only, all intervals of a day together, proven to the cent.")


def _days(ours: Study) -> list[dict[str, object]]:
    return [
        {
            "Seed": day.seed,
            "Asked": day.arrived,
            "Admitted": day.admitted,
            "Profit, $": round(day.profit, 2),
            "Solving, s": round(day.seconds, 3),
            "Slowest interval, s": round(day.slowest_seconds, 3),
        }
        for day in ours.days
    ]
