"""A run taken apart for keeping, and put together again to the bit.

Whatever a run consists of becomes one part for each field of its trace and of every step,
named by a digest of its content. Most parts are shared: the state after a step is the state
before the next, and all steps between two revisions have the same inputs. So a change adds
only the parts that are new. What fields there are is read off the data classes.
"""

import hashlib
import json
import zlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields
from functools import lru_cache
from typing import Any, get_type_hints

from pydantic import TypeAdapter

from evdash.domain.scenario import Scenario
from evdash.domain.trace import Step, Trace

COMPRESSION = 1
DIGEST_BYTES = 16
STEPS = "steps"


@dataclass(frozen=True, slots=True)
class Kept:
    """A run as it is kept: what was opened, by which name, and all that has happened since."""

    source: str
    opened: Scenario
    trace: Trace


Body = bytes
Known = dict[int, tuple[object, str]]
"""The name of every part already kept, by the identity of its object, which is held fast here."""


@lru_cache(maxsize=4)
def _hints(of: type) -> Mapping[str, Any]:
    hints = get_type_hints(of, include_extras=True)
    return {field.name: hints[field.name] for field in fields(of) if field.name != STEPS}


@lru_cache(maxsize=64)
def _adapter(hint: Any) -> TypeAdapter[Any]:
    return TypeAdapter(hint)


DAMAGED = "the record of the run is damaged"


class DamagedPart(Exception):
    """A part that is not what its name says it is."""


def _name(body: Body) -> str:
    return hashlib.blake2b(body, digest_size=DIGEST_BYTES).hexdigest()


class Taking:
    """Takes a run apart: its manifest, and the bodies of those parts that are not known yet."""

    def __init__(self, known: Known) -> None:
        self.new: dict[str, Body] = {}
        self.known: Known = {}
        self._before = known

    def manifest(self, kept: Kept) -> str:
        """What the run is made of, by the names of its parts, as JSON."""
        return json.dumps(
            {
                "source": kept.source,
                "opened": self._part(Scenario, kept.opened),
                "trace": self._record(Trace, kept.trace),
                STEPS: [self._record(Step, step) for step in kept.trace.steps],
            }
        )

    @property
    def names(self) -> set[str]:
        """All parts of the run."""
        return {name for _, name in self.known.values()}

    def _record(self, of: type, value: object) -> dict[str, str]:
        return {name: self._part(hint, getattr(value, name)) for name, hint in _hints(of).items()}

    def _part(self, hint: Any, value: object) -> str:
        known = self.known.get(id(value)) or self._before.get(id(value))
        if known is None or known[0] is not value:
            body = _adapter(hint).dump_json(value)
            name = _name(body)
            self.new[name] = zlib.compress(body, COMPRESSION)
            known = (value, name)
        self.known[id(value)] = known
        return known[1]


class Putting:
    """Puts a run together again; parts that were shared are shared again."""

    def __init__(self, read: Callable[[str], Body]) -> None:
        self.known: Known = {}
        self._read = read
        self._made: dict[tuple[str, Any], object] = {}

    def kept(self, manifest: str) -> Kept:
        """The run of a manifest; raises ValueError where it is none of this version's."""
        try:
            told = json.loads(manifest)
            steps = tuple(Step(**self._record(Step, step)) for step in told[STEPS])
            trace = Trace(**self._record(Trace, told["trace"]), steps=steps)
            opened = self._part(Scenario, told["opened"])
            return Kept(str(told["source"]), opened, trace)
        except (KeyError, TypeError) as error:
            raise ValueError(f"not a run as this version keeps it: {error}") from error

    def _record(self, of: type, names: Mapping[str, str]) -> dict[str, Any]:
        hints = _hints(of)
        return {field: self._part(hints[field], name) for field, name in names.items()}

    def _body(self, name: str) -> bytes:
        """A part's content, which its name is a digest of."""
        try:
            body = zlib.decompress(self._read(name))
        except zlib.error as error:
            raise DamagedPart(DAMAGED) from error
        if _name(body) != name:
            raise DamagedPart(DAMAGED)
        return body

    def _part(self, hint: Any, name: str) -> Any:
        place = (name, hint)
        if place not in self._made:
            value = _adapter(hint).validate_json(self._body(name))
            self._made[place] = value
            self.known[id(value)] = (value, name)
        return self._made[place]
