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

from evdash.domain.scenario import GeneratedArrivals, RecordedArrivals, Scenario
from evdash.errors import Fault, InputError
from evdash.files.checks import CHECKS, Place, Problem

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
    faulty: list[Place] = list(known_faulty)
    faults: list[Fault] = []
    scenario = None
    for _ in range(MAX_ROUNDS):  # exchanging one value may bring another fault to light
        try:
            scenario = Scenario.model_validate(raw)
            break
        except ValidationError as error:
            for details in error.errors(include_url=False):
                place = _place(details["loc"])
                if not _touches(place, faulty):
                    faults.append(_field_fault(raw, place, details, where))
                raw = _with_stand_in(raw, place, details["type"])
                faulty.append(place)
    if scenario is not None:
        for problem in (problem for check in CHECKS for problem in check(scenario)):
            if not any(_touches(place, faulty) for place in problem.places):
                faults.append(_told(problem, where))
    if faults or known_faulty or scenario is None:
        raise InputError(faults)
    return scenario


def field_at(place: Place, raw: Mapping[str, Any]) -> FieldInfo | None:
    """The declaration of the field at a place, or None if there is none."""
    model: type[BaseModel] | None = Scenario
    found: FieldInfo | None = None
    for part in place:
        if isinstance(part, int):
            continue
        if model is None or part not in model.model_fields:
            return found if found is not None and model is None else None
        found = model.model_fields[part]
        model = _record_in(found.annotation, raw)
    return found


def _record_in(annotation: Any, raw: Mapping[str, Any]) -> type[BaseModel] | None:
    """The record type inside an annotation such as tuple[Node, ...] or Feeder | None."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    inner = [_record_in(part, raw) for part in get_args(annotation)]
    records = [record for record in inner if record is not None]
    if GeneratedArrivals in records:
        recorded = "vehicles" in (raw.get("arrivals") or {})
        return RecordedArrivals if recorded else GeneratedArrivals
    wraps = get_origin(annotation) in (tuple, Union, types.UnionType, Annotated)
    return records[0] if records and wraps else None


def _place(loc: tuple[str | int, ...]) -> Place:
    if len(loc) > 1 and loc[0] == "arrivals" and loc[1] in UNION_TAGS:
        return (loc[0], *loc[2:])
    return loc


def _touches(place: Place, faulty: Sequence[Place]) -> bool:
    """Whether a place lies within a faulty one or has one within it."""
    return any(place[: len(bad)] == bad[: len(place)] for bad in faulty)


def _told(problem: Problem, where: Where) -> Fault:
    return Fault(where(problem.places[0]), problem.found, problem.allowed)


def _field_fault(raw: Raw, place: Place, details: ErrorDetails, where: Where) -> Fault:
    kind = details["type"]
    if kind == "extra_forbidden":
        owner = _record_at(place[:-1], raw)
        keys = ", ".join(owner.model_fields) if owner else ""
        return Fault(
            where(place[:-1]) or "top level", f"unknown key {place[-1]!r}", f"keys: {keys}"
        )
    message = str(details["msg"]).removeprefix("Value error, ").replace("Input should", "should")
    message = message[:1].lower() + message[1:]
    if kind == "missing":
        return Fault(where(place), "nothing", "is required" + _meaning(place, raw))
    return Fault(where(place), _shown(details["input"]), message + _meaning(place, raw))


def _record_at(place: Place, raw: Raw) -> type[BaseModel] | None:
    if not [part for part in place if isinstance(part, str)]:
        return Scenario
    field = field_at(place, raw)
    return _record_in(field.annotation, raw) if field else None


def _meaning(place: Place, raw: Raw) -> str:
    field = field_at(place, raw)
    if field is None or not field.description:
        return ""
    extra = field.json_schema_extra
    unit = extra.get("unit") if isinstance(extra, dict) else ""
    return f" ({field.description}{f', {unit}' if unit else ''})"


def _shown(value: object) -> str:
    if value is None or value == "":
        return "a blank"
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "…"


def _with_stand_in(raw: Any, place: Place, kind: str) -> Any:
    """`raw` with the faulty value at `place` taken out or exchanged for its field's example."""
    if kind == "extra_forbidden":
        return _replaced(raw, place, None, drop=True)
    named = place
    while named and (field := field_at(named, raw)) is None:
        named = named[:-1]
    if not named:
        return raw
    if isinstance(named[-1], int):
        return _replaced(raw, named, None, drop=True)
    if field is not None and field.examples:
        return _replaced(raw, named, field.examples[0], drop=False)
    record = _record_in(field.annotation, raw) if field else None
    return _replaced(raw, named, {} if record else None, drop=False)


def _replaced(node: Any, place: Place, value: Any, *, drop: bool) -> Any:
    head, rest = place[0], place[1:]
    copy: Any = dict(node) if isinstance(node, Mapping) else list(node)
    if rest:
        copy[head] = _replaced(copy[head], rest, value, drop=drop)
    elif drop:
        del copy[head]
    else:
        copy[head] = value
    return copy
