"""A study file read and checked as a whole: every fault is told before anything is run."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from pathlib import Path

from pydantic import ValidationError

from evdash.domain.arrivals import RecordedArrivals
from evdash.domain.scenario import Scenario
from evdash.domain.study import (
    ALL_NODES,
    MOST_POINTS,
    MOST_RUNS,
    Axis,
    Point,
    Run,
    Settings,
    Study,
    StudyRuns,
)
from evdash.errors import Fault, InputError
from evdash.files.bundled import bundled_scenarios, is_there, located
from evdash.files.nested import read_toml
from evdash.files.scenario_folder import read_scenario
from evdash.files.wording import allowed, found, shown
from evdash.policies.registry import known
from evdash.studies.code import code_of
from evdash.studies.keys import with_settings
from evdash.studies.measures import MEASURES

MOST_FAULTS = 50
"""So many faults of combined values are told; one wrong value spoils many of them."""
RESERVED = ("policy", "network", "seed", "status", "reason", "key", "metric", "days", "mean")


def read_study(path: Path, own: tuple[str, ...] = ()) -> StudyRuns:
    """The study in a file, ready to run; raises InputError with every fault.

    `own`: policies given by hand, which decide in place of those the file names.
    """
    try:
        text = path.read_text(encoding="utf-8-sig")
    except (OSError, UnicodeDecodeError) as error:
        fault = Fault(str(path), f"nothing readable ({error})", "should be a study file, UTF-8")
        raise InputError([fault]) from error
    study = parse_study(text, path.name)
    if own:
        study = study.model_copy(update={"policies": own})
    return lay_out(study, base_scenario(study, path.parent), own)


def parse_study(text: str, name: str = "study") -> Study:
    """The study a file's text declares, its fields each by itself; raises InputError."""
    try:
        raw = read_toml(text)
    except ValueError as error:
        raise InputError([Fault(name, f"text that is not TOML ({error})", "TOML")]) from error
    return study_of(raw)


def study_of(raw: Mapping[str, object]) -> Study:
    """The study that these keys declare, its fields each by itself; raises InputError."""
    try:
        return Study.model_validate(raw)
    except ValidationError as error:
        raise InputError(list(_field_faults(error))) from error


def _field_faults(error: ValidationError) -> Iterator[Fault]:
    for details in error.errors(include_url=False):
        *parents, last = details["loc"] or ("",)
        if details["type"] == "extra_forbidden":
            rule = "should be one of the keys in docs/studies.md"
            yield Fault(_place(parents) or "top level", f"unknown key {last!r}", rule)
            continue
        place = [part for part in details["loc"] if not str(part).startswith(("tuple[", "literal"))]
        yield Fault(_place(place), found(details), allowed(details))


def _place(parts: Sequence[str | int]) -> str:
    return ".".join(str(part + 1) if isinstance(part, int) else part for part in parts)


def base_scenario(study: Study, beside: Path) -> Scenario:
    """The base scenario: a bundled one by its name, or a folder or .zip seen from `beside`."""
    place = located(study.base, beside)
    if not is_there(place):
        bundled = ", ".join(folder.name for folder in bundled_scenarios())
        rule = f"should be a folder or .zip, or one of {bundled}"
        raise InputError([Fault("base", shown(study.base), rule)])
    try:
        return read_scenario(place)
    except InputError as error:
        raise InputError([_within(f"base {study.base}", fault) for fault in error.faults]) from None


def _within(place: str, fault: Fault) -> Fault:
    return Fault(f"{place}, {fault.place}", fault.found, fault.allowed)


def lay_out(study: Study, given: Scenario, own: tuple[str, ...] = ()) -> StudyRuns:
    """Every point and run of a study over a base scenario; raises InputError with every fault.

    Of policies that are not known by themselves, those in `own` count: a person gave them by hand.
    """
    faults = [*_policy_faults(study, own), *_naming_faults(study), *_axis_faults(study)]
    base = given
    try:
        base = with_settings(given, study.set)
    except InputError as error:
        faults += [_within("set", fault) for fault in error.faults]
    faults += _seed_faults(study, base)
    axes = [_axis_points(axis, base) for axis in study.axis]
    if not any(fault.place.startswith("set") for fault in faults):
        faults += [fault for axis in axes for fault in _alone_faults(base, axis)]
    if faults:
        raise InputError(faults)
    points = _points(base, axes)
    return StudyRuns(study, given, base, points, tuple(_runs(study, points)))


def _policy_faults(study: Study, own: tuple[str, ...]) -> Iterator[Fault]:
    """Policies that do not exist, and functions that a file names by itself."""
    for name in study.policies:
        try:
            if name not in own:
                known(name, "policies")
        except InputError as error:
            yield from error.faults


def _naming_faults(study: Study) -> Iterator[Fault]:
    """Metrics that do not exist, and whatever is named twice."""
    for name in study.metrics:
        if name not in MEASURES:
            yield Fault("metrics", shown(name), f"should be of {', '.join(MEASURES)}")
    titles = tuple(axis.title for axis in study.axis)
    several: dict[str, tuple[str, ...]] = {
        "axis": titles,
        "policies": study.policies,
        "networks": study.networks,
        "metrics": study.metrics,
    }
    for place, named in several.items():
        for name in dict.fromkeys(named):
            if named.count(name) > 1:
                yield Fault(place, f"{name!r} {named.count(name)} times", "should be there once")
    for title in titles:
        if title in {*RESERVED, *MEASURES}:
            yield Fault("axis", shown(title), "should be a name no other column has")


def _axis_faults(study: Study) -> Iterator[Fault]:
    """Axes that do not say what they vary, and values or cases that come twice."""
    for number, axis in enumerate(study.axis, 1):
        place = f"axis.{number}"
        keyed = axis.key is not None or bool(axis.values)
        if keyed == bool(axis.case):
            yield Fault(place, "key and cases" if keyed else "neither key nor cases", "one of them")
        if keyed and axis.key is None:
            yield Fault(place, "values without a key", "should have a key")
        if axis.key is not None and not axis.values:
            yield Fault(place, "no values", "should have at least one")
        if axis.values == ALL_NODES and axis.key != "station.node":
            yield Fault(f"{place}.values", f"{ALL_NODES!r}", "only station.node takes it")
        names = [case.name for case in axis.case] or [shown(value) for value in axis.values]
        for name in dict.fromkeys(names):
            if axis.values != ALL_NODES and names.count(name) > 1:
                yield Fault(place, f"{name} {names.count(name)} times", "should be there once")


def _seed_faults(study: Study, base: Scenario) -> Iterator[Fault]:
    listed = isinstance(base.arrivals, RecordedArrivals)
    if study.seeds is not None and study.seeds.count > 1 and listed:
        rule = "should be left out: the base scenario lists its arrivals, every day is the same"
        yield Fault("seeds.count", f"{study.seeds.count}", rule)
    points = 1
    for axis in study.axis:
        nodes = len(base.nodes) - 1
        points *= nodes if axis.values == ALL_NODES else max(1, len(axis.case or axis.values))
    runs = points * _days(study) * len(study.policies) * len(study.networks)
    if points > MOST_POINTS:
        yield Fault("axis", f"{points:,} combinations", f"at most {MOST_POINTS:,}")
    elif runs > MOST_RUNS:
        yield Fault("seeds", f"{runs:,} runs in all", f"at most {MOST_RUNS:,}")


def _days(study: Study) -> int:
    return 1 if study.seeds is None else study.seeds.count


Step = tuple[object, Settings]
"""A value of an axis: its label and the settings it stands for."""


def _axis_points(axis: Axis, base: Scenario) -> list[Step]:
    if axis.case:
        return [(case.name, case.set) for case in axis.case]
    if axis.key is None:
        return []
    if axis.values == ALL_NODES:
        source = base.feeder.source_node
        nodes = [node.node for node in base.nodes if node.node != source]
        return [(node, {axis.key: node}) for node in nodes]
    return [(_label(value), {axis.key: value}) for value in axis.values]


def _label(value: object) -> object:
    simple = isinstance(value, str | int | float) and not isinstance(value, bool)
    return value if simple else str(value)


def _alone_faults(base: Scenario, axis: list[Step]) -> Iterator[Fault]:
    """Faults of single values, the rest as in the base scenario."""
    for label, settings in axis:
        try:
            with_settings(base, settings)
        except InputError as error:
            for fault in error.faults:
                yield _within(f"axis, {shown(label)}", fault)


def _points(base: Scenario, axes: Sequence[Sequence[Step]]) -> tuple[Point, ...]:
    points: list[Point] = []
    faults: list[Fault] = []
    for steps in product(*axes):
        labels = tuple(label for label, _ in steps)
        settings = {key: value for _, each in steps for key, value in each.items()}
        try:
            scenario = with_settings(base, settings)
        except InputError as error:
            faults += [_within(f"axis, {', '.join(map(shown, labels))}", f) for f in error.faults]
            if len(faults) > MOST_FAULTS:
                break
            continue
        points.append(Point(labels, settings, _digest(scenario.model_dump_json())))
    if faults:
        raise InputError(faults)
    return tuple(points)


def scenario_at(runs: StudyRuns, point: int) -> Scenario:
    """The scenario of a point."""
    return with_settings(runs.base, runs.points[point].settings)


def _runs(study: Study, points: Sequence[Point]) -> Iterator[Run]:
    """Runs in the order of the tables: point, policy, network model, seed."""
    seeds: list[int | None] = [None]
    if study.seeds is not None:
        seeds = [study.seeds.first + n for n in range(study.seeds.count)]
    for p, point in enumerate(points):
        for policy, network, seed in product(study.policies, study.networks, seeds):
            told = repr((point.digest, policy, network, seed, code_of(policy)))
            # drawn by lot, so that more seeds or values leave the runs already done as they are
            first = p == 0 and seed == seeds[0]
            lot = int(_digest(told)[:8], 16)
            every = study.referee_every
            referee = every > 0 and (first or lot % every == 0)
            yield Run(_digest(f"{told} {referee}"), p, policy, network, seed, referee)


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode()).hexdigest()[:32]
