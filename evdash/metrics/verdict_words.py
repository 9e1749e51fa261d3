"""A verdict on limits in sentences, the same ones wherever limits are told."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal, Self

from evdash.domain.elements import CHARGERS, Element
from evdash.domain.trace import Network, Trace
from evdash.domain.words import counted, depth_words, element_words
from evdash.metrics.verdict import ModelVerdict, Violation

State = Literal["bad", "note", "good", "open"]
MODEL: Mapping[Network, str] = {"lindistflow": "in the linearised model", "ac": "by AC power flow"}
MOST = 3
"""So many limits are told each by itself; the tables have them all."""


@dataclass(frozen=True, slots=True)
class Sentence:
    """What a verdict comes to, and the numbers of it.

    `state`: bad, charging does it, or nothing can be said; note, the feeder does it by itself;
    good; open, not known yet.
    """

    state: State
    head: str
    details: str = ""

    @property
    def text(self) -> str:
        """The whole of it."""
        return f"{self.head}: {self.details}." if self.details else f"{self.head}."


@dataclass(frozen=True, slots=True)
class Wording:
    """How sentences call what is exceeded, when an interval begins, and what users have named."""

    limit: Callable[[Violation], str]
    at: Callable[[int], str]
    name: Callable[[str], str] = str

    @classmethod
    def of(cls, trace: Trace, at: Callable[[int], str], name: Callable[[str], str] = str) -> Self:
        """With limits as they were in force then. `name` sets what users have called things."""

        def limit(one: Violation) -> str:
            scenario = trace.inputs_at(one.worst).scenario
            return element_words(one.element, scenario, name)

        return cls(limit, at, name)


def sentences(models: Sequence[ModelVerdict], wording: Wording) -> list[Sentence]:
    """What each model says, charging's doing first; where limits hold in all, once for all."""
    told = [
        one
        for tell in (_by_charging, _chargers, _without_solution, _by_feeder, _unknown)
        for model in models
        for one in tell(model, wording)
    ]
    told = list(dict.fromkeys(told))
    holding = [MODEL[model.network] for model in models if model.holds]
    if holding:
        told.append(Sentence("good", f"Every limit holds {' and '.join(holding)}"))
    return told


def in_brief(model: ModelVerdict, wording: Wording) -> str:
    """What charging exceeds, the worst of each kind alone: for one of many days in a sentence."""
    worst: dict[str, Violation] = {}
    for one in model.by_charging:
        if one.unit not in worst or one.depth > worst[one.unit].depth:
            worst[one.unit] = one
    return ", ".join(
        f"no AC solution at {wording.at(one.worst)}"
        if one.element.kind == "power_flow"
        else f"{wording.limit(one)} by {depth_words(one.depth, one.unit)} at "
        f"{wording.at(one.worst)}"
        for one in worst.values()
    )


def _by_charging(model: ModelVerdict, wording: Wording) -> list[Sentence]:
    found = [one for one in model.by_charging if _is_of_feeder(one)]
    if not found:
        return []
    does = f"charging exceeds {_limits(found)}"
    if all(one.cause == "both" for one in found):
        does = f"charging worsens {_limits(found)} that the feeder exceeds by itself"
    return [Sentence("bad", f"{_model(model)}, {does}", _each(found, wording))]


def _model(model: ModelVerdict) -> str:
    told = MODEL[model.network]
    return told[:1].upper() + told[1:]


def _is_of_feeder(one: Violation) -> bool:
    return one.element.is_voltage or one.element.is_rating


def _chargers(model: ModelVerdict, wording: Wording) -> list[Sentence]:
    """A limit of the station, the same in both models."""
    found = [one for one in model.by_charging if one.element == CHARGERS]
    head = "More vehicles charge than there are chargers"
    return [Sentence("bad", head, f"{_group([one], wording)}") for one in found]


def _by_feeder(model: ModelVerdict, wording: Wording) -> list[Sentence]:
    found = [one for one in model.by_feeder if _is_of_feeder(one)]
    if not found:
        return []
    does = f"the feeder by itself exceeds {_limits(found)}, which charging does not worsen"
    return [Sentence("note", f"{_model(model)}, {does}", _each(found, wording))]


def _without_solution(model: ModelVerdict, wording: Wording) -> list[Sentence]:
    return [
        Sentence(
            "bad",
            f"AC power flow has no solution {'with' if one.by_charging else 'even without'} "
            "charging, voltage may collapse",
            _when(one.intervals, one.intervals[0], wording, "first"),
        )
        for one in model.violations
        if one.element.kind == "power_flow"
    ]


def _unknown(model: ModelVerdict, wording: Wording) -> list[Sentence]:
    told = [
        Sentence(
            "bad",
            f"{counted(intervals, 'interval')} could not be checked",
            f"the AC power flow itself failed ({wording.name(failure)})",
        )
        for failure, intervals in Counter(model.failures).items()
    ]
    if model.waiting:
        many = counted(model.waiting, "interval is", "intervals are")
        told.append(Sentence("open", f"{many} still being checked {MODEL[model.network]}"))
    elif not model.judged and not told:
        told.append(Sentence("open", "AC power flow checks each interval once it is over"))
    return told


def _limits(found: Iterable[Violation]) -> str:
    return counted(len({one.element for one in found}), "limit")


def _each(found: Sequence[Violation], wording: Wording) -> str:
    """Limit by limit: which, by how much, when. Neighbours' voltages go together: one for all."""
    groups: dict[Element | str, list[Violation]] = {}
    for one in found:
        of = one.element.kind if one.element.is_voltage else one.element
        groups.setdefault(of, []).append(one)
    told = [_group(group, wording) for group in groups.values()]
    rest = [one for group in list(groups.values())[MOST:] for one in group]
    return "; ".join([*told[:MOST], *([f"and {_limits(rest)} more"] if rest else [])])


def _group(group: Sequence[Violation], wording: Wording) -> str:
    worst = max(group, key=lambda one: one.depth)
    intervals = sorted({t for one in group for t in one.intervals})
    elements = {one.element for one in group}
    others = len(elements) - 1
    also = f", and at {counted(others, 'other node')}," if others else ""
    own = ", in part without charging" if any(one.cause == "both" for one in group) else ""
    upto = "up to " if others or len(intervals) > 1 else ""
    return (
        f"{wording.limit(worst)}{also} by {upto}"
        f"{depth_words(worst.depth, worst.unit)} {_when(intervals, worst.worst, wording, 'worst')}"
        f"{own}"
    )


def _when(intervals: Sequence[int], one: int, wording: Wording, which: str) -> str:
    if len(intervals) == 1:
        return f"at {wording.at(one)}"
    return f"in {counted(len(intervals), 'interval')}, {which} at {wording.at(one)}"
