"""The policies by name: how each is made for a day, and how its plans come to count.

Ours, those that installed packages declare as entry points, and functions a person names on the
command line. A name that comes from a file, a link or a page never has a module imported that is
not installed for it: `known` finds ours and installed ones only, `given` is the command line's.
"""

import os
import re
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from importlib.metadata import EntryPoint, entry_points
from typing import NoReturn

from evdash.domain.plan import Policy, Snapshot, is_outside
from evdash.domain.trace import Inputs
from evdash.errors import Fault, InputError
from evdash.horizon.day import Decide, answered_plan, certified_plan
from evdash.policies.bid_price import bid_price
from evdash.policies.oracle import oracle
from evdash.policies.outside import Outside, certified_for
from evdash.policies.rules import (
    by,
    earliest_deadline,
    first_come,
    least_laxity,
    uncoordinated,
)
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.reference import solve_reference

GROUP = "evdash.policies"
"""The entry points by which an installed package offers policies."""
TITLE = re.compile(r"\w[\w.-]{0,39}")
NAMELESS = "own:policy"
OWN = "or module:function, one of your own (docs/policies.md)"
NOT_BY_FILE = "(one of your own counts where it is installed, or named on the command line)"
FROM_OUTSIDE = "A policy from outside; its plans are checked like all others."


@dataclass(frozen=True, slots=True)
class Rule:
    """A policy's name, the same in words, what it does, how it is made, how its plans count."""

    name: str
    title: str
    told: str
    make: Callable[[Inputs], Policy]
    decide: Decide = certified_plan

    @property
    def keeps_limits(self) -> bool:
        """Whether its plans count only if they keep every limit and contract."""
        return self.decide is not answered_plan


OURS = (
    Rule(
        "p1",
        "P1, the paper's",
        "Admits what earns most of those who ask now, whoever may come later.",
        lambda _: p1_policy(),
    ),
    Rule(
        "p1-plain",
        "P1, solved plainly",
        "The same problem as the paper writes it, handed whole to a solver: slower, to compare.",
        lambda _: p1_policy(solve_reference),
    ),
    Rule(
        "bid-price",
        "bid-price",
        "Admits what earns most together with those expected to come, of whom it knows only "
        "the statistics.",
        lambda inputs: bid_price(inputs.scenario),
    ),
    Rule(
        "fcfs",
        "First come, first served",
        "Charges in order of arrival and admits whoever then still fits.",
        lambda _: by(first_come),
    ),
    Rule(
        "edf",
        "Earliest deadline first",
        "Charges who has to be back first, and admits whoever then still fits.",
        lambda _: by(earliest_deadline),
    ),
    Rule(
        "llf",
        "Least laxity first",
        "Charges who could wait least, and admits whoever then still fits.",
        lambda _: by(least_laxity),
    ),
    Rule(
        "uncoordinated",
        "Uncoordinated",
        "Admits everyone and charges at full power at once; keeps no limit of feeder or station.",
        lambda _: uncoordinated,
        answered_plan,
    ),
    Rule(
        "oracle",
        "Oracle",
        "Knows in advance who will come: no policy that keeps the same limits can earn more.",
        oracle,
    ),
)
RULES: Mapping[str, Rule] = {rule.name: rule for rule in OURS}


@lru_cache(maxsize=1)
def installed() -> Mapping[str, Rule]:
    """The policies of installed packages, by `module:function`; none is imported before its use.

    One is called by its entry point's name where that is a plain word and none of ours.
    """
    return {
        point.value: _from_outside(point.value, _title(point), partial(_loaded, point))
        for point in entry_points(group=GROUP)
        if is_outside(point.value)
    }


def choices() -> Mapping[str, Rule]:
    """All policies that can be chosen by name: ours, and those of installed packages."""
    return {**RULES, **installed()}


def known(name: str, place: str = "policy") -> Rule:
    """A policy of ours, or of an installed package by the name it gives or `module:function`.

    Raises InputError, which lists what there is; `place` says where the name stands.
    """
    named = {rule.title: rule for rule in installed().values()}
    found = choices().get(name) or named.get(name)
    return found or _nobodys(name, place)


def given(name: str, place: str = "--policy") -> Rule:
    """As `known`, or a function of a person's own, `module:function`, imported from where they are.

    Raises InputError. For names given on a command line alone: importing runs what is there.
    """
    if name in RULES or not is_outside(name) or name in installed():
        try:
            return known(name, place)
        except InputError:
            raise InputError([Fault(place, repr(name), f"{_there_are()}, {OWN}")]) from None
    if not {"", os.getcwd()} & set(sys.path):  # where `python -m` begins to look, too
        sys.path.insert(0, os.getcwd())
    function = _loaded(EntryPoint(name, name, GROUP), place)
    return _from_outside(name, name, lambda: function)


def own(function: Callable[[Snapshot], object]) -> Rule:
    """A function that a program hands over, named `module:function` as far as it has a name."""
    module, name = (getattr(function, key, "") for key in ("__module__", "__name__"))
    title = f"{module}:{name}"
    title = title if is_outside(title) else NAMELESS
    return _from_outside(title, title, lambda: function)


def all_given(names: Sequence[str], place: str) -> Mapping[str, Rule]:
    """As `given`, by their names; raises InputError with everything that is wrong."""
    rules: dict[str, Rule] = {}
    faults: list[Fault] = []
    for name in names:
        if not isinstance(name, str):
            faults.append(Fault(place, f"{name!r}", "should be a name, such as module:function"))
            continue
        try:
            rule = given(name, place)
        except InputError as error:
            faults += error.faults
        else:
            rules[rule.name] = rule
    if faults:
        raise InputError(faults)
    return rules


def described(name: str) -> Rule:
    """What can be said of a policy by its name, whatever it is; one not known is not made."""
    return choices().get(name) or _from_outside(name, name, partial(_nobodys, name))


def _title(point: EntryPoint) -> str:
    plain = TITLE.fullmatch(point.name) and point.name not in RULES
    return point.name if plain else point.value


def _there_are() -> str:
    return f"should be one of {', '.join([*RULES, *(r.title for r in installed().values())])}"


def _from_outside(name: str, title: str, load: Callable[[], Callable[[Snapshot], object]]) -> Rule:
    return Rule(name, title, FROM_OUTSIDE, lambda _: Outside(load()), certified_for(name))


def _loaded(point: EntryPoint, place: str = "") -> Callable[[Snapshot], object]:
    """The function an entry point names; raises InputError where there is none."""
    place = place or f"policy {point.name}"
    try:
        found = point.load()
    except (Exception, SystemExit) as error:
        told = f"{point.value}, which cannot be imported ({type(error).__name__}: {error})"
        raise InputError([Fault(place, told, f"{_there_are()}, {OWN}")]) from error
    if not callable(found):
        told = f"{point.value}, which is of type {type(found).__name__}"
        raise InputError([Fault(place, told, "should be a function of a snapshot")])
    function: Callable[[Snapshot], object] = found
    return function


def _nobodys(name: str, place: str = "policy") -> NoReturn:
    raise InputError([Fault(place, repr(name), f"{_there_are()} {NOT_BY_FILE}")])
