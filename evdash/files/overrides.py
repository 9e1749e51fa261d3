"""Single settings laid over a scenario: `--set station.chargers=8`, and the app's edits."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from evdash.domain.scenario import Scenario
from evdash.errors import Fault, InputError
from evdash.files.checks import Place
from evdash.files.nested import MOST_LEVELS, read_toml
from evdash.files.validate import Raw, dotted, field_at, validate

FILE_KEYS = ("arrivals.file", "arrivals.fleet", "arrivals.forecast.fleet")


@dataclass(frozen=True, slots=True)
class Setting:
    """A key of scenario.toml, options by name, and the value it is to have."""

    key: str
    value: object


def parse_setting(text: str) -> Setting:
    """KEY=VALUE as typed: VALUE read as TOML, else as text; a text key's taken as it stands."""
    key, equals, value = text.partition("=")
    key = key.strip()
    if not equals or not key:
        raise InputError([Fault("--set", repr(text), "should be KEY=VALUE")])
    return setting_of(key, value)


def setting_of(key: str, text: str) -> Setting:
    """A key and its value as text: read as TOML, else as text; a text key's taken as it stands."""
    return Setting(key, text if is_text_key(key) else _as_toml(text))


def is_text_key(key: str) -> bool:
    """Whether a key holds text, so that 634 means the name and not the number."""
    if key in FILE_KEYS:
        return True
    parts = key.split(".")
    place: Place = ("option", 0, parts[-1]) if parts[0] == "option" else tuple(parts)
    field = field_at(place, {})
    return field is not None and field.annotation is str


def _as_toml(text: str) -> object:
    try:
        read = read_toml(f"value = {text}")
    except ValueError:
        return text
    return read["value"] if list(read) == ["value"] else text


def apply_settings(raw: Raw, settings: Sequence[Setting]) -> tuple[Raw, list[Fault]]:
    """`raw` with the settings in force, the later winning, and the faults of their keys.

    Whether a key exists and its value will do is for validation to say.
    """
    faults: list[Fault] = []
    for setting in settings:
        try:
            raw = _with(raw, _path(raw, setting.key), setting.value)
        except LookupError as error:
            faults.append(Fault(f"--set {setting.key}", f"{error.args[0]}", "unknown key"))
    return raw, list(dict.fromkeys(faults))


def _path(raw: Raw, key: str) -> Place:
    parts = key.split(".")
    if len(parts) > MOST_LEVELS:
        raise LookupError(f"a key of {len(parts)} parts")
    if "option_share" in parts[:-1]:
        table = parts[: parts.index("option_share") + 1]
        return (*table, ".".join(parts[len(table) :]))  # names of options may have dots
    if parts[0] != "option" or len(parts) == 1:
        return tuple(parts)
    if len(parts) == 2:
        raise LookupError("a price option without a key, as in option.C1.price_per_kwh")
    name, field = ".".join(parts[1:-1]), parts[-1]
    options = raw.get("option")
    for i, option in enumerate(options if isinstance(options, Sequence) else ()):
        if isinstance(option, Mapping) and option.get("name") == name:
            return ("option", i, field)
    raise LookupError(f"no price option {name!r}")


def _with(node: Any, path: Place, value: object) -> Any:
    if not path:
        return value
    if isinstance(node, list | tuple) and isinstance(path[0], int):
        return [
            _with(part, path[1:], value) if i == path[0] else part for i, part in enumerate(node)
        ]
    if not isinstance(node, Mapping):
        raise LookupError(f"no table that could hold {dotted(path)!r}")
    inner = node.get(str(path[0]), {} if len(path) > 1 else None)
    return dict(node) | {str(path[0]): _with(inner, path[1:], value)}


def edit_scenario(
    scenario: Scenario,
    settings: Mapping[str, object],
    price_per_kwh: Sequence[float] | None = None,
) -> Scenario:
    """The scenario with some keys and, if given, all energy prices ($/kWh) exchanged.

    Validated like any other; raises InputError with every fault.
    """
    raw = scenario.model_dump(exclude_none=False)
    raw, faults = apply_settings(raw, [Setting(key, value) for key, value in settings.items()])
    if faults:
        raise InputError(faults)
    if price_per_kwh is not None:
        raw["profile"] = [
            row.model_dump() | {"price_per_kwh": price}
            for row, price in zip(scenario.profile, price_per_kwh, strict=True)
        ]
    return validate(raw)


def parse_settings(texts: Sequence[str]) -> tuple[Setting, ...]:
    """Several KEY=VALUE as typed; raises InputError with every one that is not."""
    settings: list[Setting] = []
    faults: list[Fault] = []
    for text in texts:
        try:
            settings.append(parse_setting(text))
        except InputError as error:
            faults += error.faults
    if faults:
        raise InputError(faults)
    return tuple(settings)
