"""What a case has a lecturer press: told in words, done by the functions the buttons call.

`key` is the widget's, `label` what is written on it. No Streamlit in here.
"""

from dataclasses import dataclass
from typing import ClassVar, Protocol

from evdash.domain.trace import Network
from evdash.ui import run as runs
from evdash.ui.curves import curve_prices, curve_title
from evdash.ui.run import Run
from evdash.ui.settings import NETWORK_NAMES
from evdash.ui.solving import policy
from evdash.ui.whatif import prompts


class Doing(Protocol):
    """Something to press, choose or set."""

    @property
    def key(self) -> str:
        """The widget's key."""

    @property
    def label(self) -> str:
        """What is written on the widget."""

    @property
    def told(self) -> str:
        """What to do, as Markdown, to go on a sentence with."""

    def done(self, run: Run) -> Run:
        """The run once it is done."""


@dataclass(frozen=True, slots=True)
class StepUntil:
    """Step until the clock shows a time, `HH:MM`."""

    clock: str
    key: ClassVar[str] = "step"
    label: ClassVar[str] = "Step"

    @property
    def told(self) -> str:
        return f"press **{self.label}** until the clock shows {self.clock}"

    def steps(self, run: Run) -> int:
        """How many steps that takes; to the end of the day where it shows no such time."""
        scenario, now = run.trace.scenario, run.trace.now
        for t in range(now, scenario.intervals):
            if f"{scenario.time_of(t):%H:%M}" == self.clock:
                return t - now
        return scenario.intervals - now

    def done(self, run: Run) -> Run:
        for _ in range(self.steps(run)):
            run = runs.stepped(run, policy)
        return run


@dataclass(frozen=True, slots=True)
class Finish:
    """Run to the end of the day."""

    key: ClassVar[str] = "finish"
    label: ClassVar[str] = "Run to end"

    @property
    def told(self) -> str:
        return f"press **{self.label}**"

    def done(self, run: Run) -> Run:
        while not run.trace.is_over:
            run = runs.stepped(run, policy)
        return run


@dataclass(frozen=True, slots=True)
class Reset:
    """Back to the start of the day, with the settings now in force."""

    key: ClassVar[str] = "reset"
    label: ClassVar[str] = "Reset"

    @property
    def told(self) -> str:
        return f"press **{self.label}**"

    def done(self, run: Run) -> Run:
        return runs.restarted(run)


@dataclass(frozen=True, slots=True)
class Ask:
    """Press one of the prompts after What if."""

    prompt: str
    label: str

    @property
    def key(self) -> str:
        return f"prompt_{self.prompt}"

    @property
    def told(self) -> str:
        return f"press **{self.label}**"

    def done(self, run: Run) -> Run:
        change = next(p.change for p in prompts(run) if p.key == self.prompt)
        return run if change is None else change(run)


@dataclass(frozen=True, slots=True)
class Set:
    """Set a number in the sidebar."""

    key: str
    label: str
    value: float

    @property
    def told(self) -> str:
        return f"set **{self.label}** to {self.value:g}"

    def done(self, run: Run) -> Run:
        return runs.edited(run, self.label, {self.key: self.value})


@dataclass(frozen=True, slots=True)
class Curve:
    """Choose an energy price curve in the sidebar."""

    value: str
    key: ClassVar[str] = "price_curve"
    label: ClassVar[str] = "Energy price"

    @property
    def told(self) -> str:
        return f"choose **{self.value}** under **{self.label}**"

    def done(self, run: Run) -> Run:
        title, prices = curve_title(self.value), curve_prices(run.trace, self.value)
        return runs.edited(run, title, {}, prices)


@dataclass(frozen=True, slots=True)
class Limits:
    """Choose the network model whose limits are kept."""

    value: Network
    key: ClassVar[str] = "network"
    label: ClassVar[str] = "Limits kept in"

    @property
    def told(self) -> str:
        return f"choose **{NETWORK_NAMES[self.value]}** under **{self.label}**"

    def done(self, run: Run) -> Run:
        return runs.rewired(run, self.value)


@dataclass(frozen=True, slots=True)
class Pick:
    """Pick somebody in a list; changes nothing."""

    key: ClassVar[str] = "why"
    label: ClassVar[str] = "Why was it refused?"

    @property
    def told(self) -> str:
        return f"pick a vehicle under **{self.label}**"

    def done(self, run: Run) -> Run:
        return run
