"""Why a request is refused: a kind with its figures, and the one place where it is put in words.

Whoever tells a refusal, on screen, in a file or in an explanation, takes `clause` (the kind
alone) or `str` (with its figures) from here; nobody reads a sentence.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator

from evdash.domain.elements import Kept
from evdash.domain.words import element_name, money

RefusalKind = Literal[
    "after the end",
    "no chargers",
    "unattainable",
    "end of horizon",
    "promises short",
    "energy",
    "feeder",
    "feeder cost",
    "headroom",
    "chargers",
    "headroom or chargers",
    "headroom and chargers",
    "contracts cost",
    "cent",
    "outbid",
    "kept for others",
    "rule",
    "best day",
    "left out",
    "policy",
    "fallback",
    "as told",
]
CLAUSES: dict[RefusalKind, str] = {
    "after the end": "it came after the last interval had begun",
    "no chargers": "the station has no chargers",
    "unattainable": "no whole number of intervals can give what it needs",
    "end of horizon": "there is too little time before the horizon's end",
    "promises short": "a promise already made cannot be kept as things stand, and until that is "
    "over nobody new is admitted",
    "energy": "its energy costs no less than it pays",
    "feeder": "the feeder by itself leaves too little headroom before its return",
    "feeder cost": "the feeder by itself leaves headroom only when energy costs no less than it "
    "pays",
    "headroom": "contracts already made need the feeder's headroom before its return",
    "chargers": "contracts already made need the chargers before its return",
    "headroom or chargers": "contracts already made need the feeder's headroom and the chargers "
    "before its return, and more of either would do",
    "headroom and chargers": "contracts already made need the feeder's headroom and the chargers "
    "before its return, and more of one alone would not do",
    "contracts cost": "charging it beside the contracts already made costs no less than it pays",
    "cent": "charging it would earn no more than the cent to which plans are decided",
    "outbid": "newcomers who earn more took its place",
    "kept for others": "room was kept for others",
    "rule": "the rule of precedence would then not serve everyone in time",
    "best day": "it is no part of the best day, the whole of it known in advance",
    "left out": "the best plan found leaves it out",
    "policy": "the policy that decides, one from outside, leaves it out",
    "fallback": "no new plan was found that passes every check, so that the last one was kept",
    "as told": "a reason given by an earlier version",
}
"""Each kind as a clause that may follow "because", without figures."""
MOST_NAMED = 3


@dataclass(frozen=True, slots=True)
class RefusalReason:
    """Why a request is refused.

    Which figures there are is for the kind to say, and they are blank where it has none:
    `cost` and `pays`, in $, of its energy (or of all that charging it would add), and what its
    driver pays; `loss`, in $, expected; `need_kwh`, `max_kw` and `low_kw`, the lowest power a
    charger gives it; `intervals`, those it takes, and `left`, those that are left; `elements`,
    the feeder's that leave too little headroom; `by`, the newcomers admitted in its place;
    `where`, the rule, the hour for which room is kept, what a policy from outside says of it, or
    what was wrong with that policy's plan; `told`, an earlier version's words.
    """

    kind: RefusalKind
    cost: float = 0.0
    pays: float = 0.0
    loss: float = 0.0
    need_kwh: float = 0.0
    max_kw: float = 0.0
    low_kw: float = 0.0
    intervals: int = 0
    left: int = 0
    elements: tuple[Kept, ...] = ()
    by: tuple[str, ...] = ()
    where: str = ""
    told: str = ""

    @property
    def clause(self) -> str:
        """The kind in words, the same for all of a kind."""
        return self.told or CLAUSES[self.kind]

    @property
    def figures(self) -> str:
        """What there is to tell beyond the kind; may be empty."""
        return _FIGURES[self.kind](self) if self.kind in _FIGURES else ""

    def __str__(self) -> str:
        return f"{self.clause}: {figures}" if (figures := self.figures) else self.clause


def _unattainable(reason: RefusalReason) -> str:
    if reason.max_kw < reason.low_kw:
        return (
            f"it takes at most {reason.max_kw:g} kW, a charger gives at least {reason.low_kw:g} kW"
        )
    return (
        f"{reason.need_kwh:.2f} kWh is more than {reason.intervals - 1} intervals at "
        f"{reason.max_kw:g} kW and less than {reason.intervals} at {reason.low_kw:g} kW"
    )


def _too_late(reason: RefusalReason) -> str:
    left = f"{reason.left} {'is' if reason.left == 1 else 'are'} left"
    return (
        f"{reason.need_kwh:.1f} kWh takes {reason.intervals} intervals at {reason.max_kw:g} kW "
        f"and only {left}"
    )


def _costs(reason: RefusalReason) -> str:
    return f"at least {money(reason.cost)}, and it pays {money(reason.pays)}"


def _energy(reason: RefusalReason) -> str:
    return f"{_costs(reason)} for {reason.need_kwh:.1f} kWh"


def _feeder(reason: RefusalReason) -> str:
    return named([element_name(element) for element in reason.elements])


def _outbid(reason: RefusalReason) -> str:
    return named(reason.by)


def _kept(reason: RefusalReason) -> str:
    told = f"admitting it is expected to lose {money(reason.loss)} more than it pays"
    return f"{told}, room being worth most at {reason.where}" if reason.where else told


def _where(reason: RefusalReason) -> str:
    return reason.where


_FIGURES = {
    "unattainable": _unattainable,
    "end of horizon": _too_late,
    "energy": _energy,
    "feeder": _feeder,
    "feeder cost": _costs,
    "headroom": _feeder,
    "headroom or chargers": _feeder,
    "headroom and chargers": _feeder,
    "contracts cost": _costs,
    "outbid": _outbid,
    "kept for others": _kept,
    "rule": _where,
    "policy": _where,
    "fallback": _where,
}


def named(names: Sequence[str]) -> str:
    """`a`, `a and b`, `a, b, c and 4 more`."""
    shown = list(names[:MOST_NAMED])
    if len(names) > MOST_NAMED:
        shown.append(f"{len(names) - MOST_NAMED} more")
    return " and ".join([", ".join(shown[:-1]), shown[-1]] if len(shown) > 1 else shown)


def _from_older(value: Any) -> Any:
    """Earlier versions kept a sentence, blank for none: it stays the sentence it was."""
    if isinstance(value, str):
        return RefusalReason("as told", told=value) if value else None
    return value


Given = Annotated[RefusalReason, BeforeValidator(_from_older)]
"""A reason as it is read back, also from what earlier versions kept."""
GivenOrNone = Annotated[RefusalReason | None, BeforeValidator(_from_older)]
"""The same where there may be none."""
