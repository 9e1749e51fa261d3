"""A scenario checked as a whole, with all its faults told at once.

Fields first, each by its own declaration. Faulty values are then exchanged for their field's
example so that the checks between fields can run too; a check that draws on a faulty place
stays silent.
"""

import types
from collections.abc import Callable, Mapping, Sequence
from typing import Annotated, Any, Union, get_args, get_origin

from pydantic import BaseModel, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails

from evdash.domain.arrivals import GeneratedArrivals, RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.errors import Fault, InputError
from evdash.files.checks import CHECKS, EVERY, Place, Problem
from evdash.files.event_checks import EVENT_CHECKS
from evdash.files.wording import allowed, found, meaning

Raw = dict[str, Any]
Where = Callable[[Place], str]
UNION_TAGS = ("generated", "recorded")
MAX_ROUNDS = 20


def dotted(place: Place) -> str:
    """A place as a key of scenario.toml, `station.chargers`."""
    return ".".join(str(part) for part in place)


def validate(raw: Raw, where: Where = dotted, known_faulty: Sequence[Place] = ()) -> Scenario:
    """The scenario `raw` describes; raises InputError with every fault found.

    `where` words a place; `known_faulty` lists places already told to be wrong, which are
    neither told again nor drawn on. The error then carries only the faults found here.
    """
    faulty = Places(known_faulty)
    faults: list[Fault] = []
    scenario = None
    for _ in range(MAX_ROUNDS):  # exchanging one value may bring another fault to light
        try:
            scenario = Scenario.model_validate(raw)
            break
        except ValidationError as error:
            for details in error.errors(include_url=False):
                place = _place(details["loc"])
                if not faulty.touch(place):
                    faults.append(_field_fault(raw, place, details, where))
                faulty.add(place)
            raw = _with_stand_ins(raw, error)
    if scenario is not None:
        checks = (*CHECKS, *EVENT_CHECKS)
        for problem in (problem for check in checks for problem in check(scenario)):
            if not _draws_on(problem, faulty):
                faults.append(_told(problem, where))
    if faults or known_faulty or scenario is None:
        raise InputError(faults)
    return scenario


def field_at(place: Place, raw: Mapping[str, Any]) -> FieldInfo | None:
    """The declaration of the field at a place, or of the field it lies within; None if none."""
    field, rest, record = _leaf(place, raw)
    named_rest = [part for part in rest if isinstance(part, str)]
    return None if named_rest and (field is None or record is not None) else field


def _leaf(
    place: Place, raw: Mapping[str, Any]
) -> tuple[FieldInfo | None, Place, type[BaseModel] | None]:
    """The innermost declared field on the way to a place, what of the way lies within it, and
    the kind of record it holds."""
    field: FieldInfo | None = None
    record: type[BaseModel] | None = Scenario
    rest = place
    for i, part in enumerate(place):
        if isinstance(part, int):
            continue
        if record is None or part not in record.model_fields:
            break
        field = record.model_fields[part]
        record = _record_in(field.annotation, raw)
        rest = place[i + 1 :]
    return field, rest, record


def _record_in(annotation: Any, raw: Mapping[str, Any]) -> type[BaseModel] | None:
    """The record type inside an annotation such as tuple[Node, ...] or Feeder | None."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    inner = [_record_in(part, raw) for part in get_args(annotation)]
    records = [record for record in inner if record is not None]
    if GeneratedArrivals in records:
        arrivals = raw.get("arrivals")
        recorded = isinstance(arrivals, Mapping) and "vehicles" in arrivals
        return RecordedArrivals if recorded else GeneratedArrivals
    wraps = get_origin(annotation) in (tuple, Union, types.UnionType, Annotated)
    return records[0] if records and wraps else None


def _place(loc: tuple[str | int, ...]) -> Place:
    if len(loc) > 1 and loc[0] == "arrivals" and loc[1] in UNION_TAGS:
        return (loc[0], *loc[2:])
    return loc


class Places:
    """Faulty places, and whether another has to do with them."""

    def __init__(self, places: Sequence[Place]) -> None:
        self._places: set[Place] = set()
        self._around: set[Place] = set()
        for place in places:
            self.add(place)

    def add(self, place: Place) -> None:
        every = tuple(EVERY if isinstance(part, int) else part for part in place)
        self._places |= {place, every}
        self._around |= {place[:length] for length in range(len(place) + 1)}

    def hold(self, place: Place) -> bool:
        """Whether `place` is faulty or lies within a faulty place; of every row, whether any is."""
        return any(place[:length] in self._places for length in range(len(place) + 1))

    def touch(self, place: Place) -> bool:
        """Whether `place` lies within a faulty place or has one within it."""
        return self.hold(place) or place in self._around


def _draws_on(problem: Problem, faulty: Places) -> bool:
    alone = len(problem.places) == 1
    return any(faulty.touch(p) if alone else faulty.hold(p) for p in problem.places)


def _told(problem: Problem, where: Where) -> Fault:
    return Fault(where(problem.places[0]), problem.found, problem.allowed)


def _field_fault(raw: Raw, place: Place, details: ErrorDetails, where: Where) -> Fault:
    if details["type"] == "extra_forbidden":
        owner = _record_at(place[:-1], raw)
        keys = ", ".join(_keys(owner)) if owner else ""
        return Fault(
            where(place[:-1]) or "top level", f"unknown key {place[-1]!r}", f"keys are {keys}"
        )
    return Fault(where(place), found(details), allowed(details) + meaning(field_at(place, raw)))


def _keys(record: type[BaseModel]) -> list[str]:
    """The keys of a record as scenario.toml has them: tables are files of their own."""
    in_files = {"nodes", "lines", "profile", "events"} if record is Scenario else set()
    names = [name for name in record.model_fields if name not in in_files]
    return ["file" if name == "vehicles" else name for name in names]


def _record_at(place: Place, raw: Raw) -> type[BaseModel] | None:
    if not [part for part in place if isinstance(part, str)]:
        return Scenario
    field = field_at(place, raw)
    return _record_in(field.annotation, raw) if field else None


def _with_stand_ins(raw: Raw, error: ValidationError) -> Raw:
    """`raw` with every faulty field exchanged for an example and every unknown key taken out."""
    repaired: Raw = _copied(raw)
    for details in error.errors(include_url=False):
        place = _place(details["loc"])
        if details["type"] == "extra_forbidden":
            _replace(repaired, place, _TAKEN_OUT)
            continue
        field, rest, record = _leaf(place, raw)
        if field is None:
            continue
        within = rest[:1] if record is not None else ()  # one record of a list, or all of it
        example = _example_record(record) if within and record else _example(field, record)
        named = place[: len(place) - len(rest)] + within
        _replace(repaired, named, example)
    return repaired


def _example(field: FieldInfo, record: type[BaseModel] | None) -> Any:
    if record is None:
        return field.examples[0] if field.examples else None
    if get_origin(field.annotation) is not tuple:
        return _example_record(record)
    shortest = max((getattr(m, "min_length", 0) or 0 for m in field.metadata), default=0)
    return [_example_record(record)] * shortest


def _example_record(record: type[BaseModel]) -> Raw:
    return {
        name: _example(field, _record_in(field.annotation, {}))
        for name, field in record.model_fields.items()
    }


_TAKEN_OUT = object()


def _copied(node: Any) -> Any:
    """Tables and lists copied as deep as they go, once for however many faults."""
    if isinstance(node, Mapping):
        return {key: _copied(value) for key, value in node.items()}
    return [_copied(part) for part in node] if isinstance(node, list | tuple) else node


def _replace(node: Any, place: Place, value: Any) -> None:
    *way, last = place
    for part in way:
        node = node[part]
    if value is _TAKEN_OUT:
        del node[last]
    else:
        node[last] = value
