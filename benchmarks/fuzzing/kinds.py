"""Every kind of input: how one is made from a random stream, and what is done with it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from benchmarks.fuzzing import importers, trial
from benchmarks.fuzzing.archives import spoilt_zip
from benchmarks.fuzzing.folders import BASES, base, spoilt_folder
from benchmarks.fuzzing.overrides import spoilt_settings
from benchmarks.fuzzing.trial import Outcome


@dataclass(frozen=True, slots=True)
class Kind:
    """A kind of input. `share`: how many of all inputs are of this kind, relative to others."""

    make: Callable[[np.random.Generator], Any]
    act: Callable[[Any], Outcome]
    share: float = 1.0


def _with_settings(rng: np.random.Generator) -> tuple[dict[str, bytes], list[str]]:
    return dict(base(int(rng.integers(0, BASES)))), spoilt_settings(rng)


KINDS: Mapping[str, Kind] = {
    "scenario folder": Kind(spoilt_folder, trial.folder, 4.0),
    "scenario page": Kind(spoilt_folder, trial.draft, 1.0),
    "zip": Kind(spoilt_zip, trial.archive, 2.0),
    "--set": Kind(_with_settings, trial.settings, 2.0),
    **{name: Kind(make, act) for name, make, act in importers.MAKERS},
}


def made(name: str, seed: int, number: int) -> Any:
    """Input `number` of a kind, the same for the same seed on every machine."""
    return KINDS[name].make(_stream(name, seed, number))


def answered(name: str, seed: int, number: int) -> Outcome:
    """What becomes of input `number` of a kind."""
    return KINDS[name].act(made(name, seed, number))


def _stream(name: str, seed: int, number: int) -> np.random.Generator:
    return np.random.default_rng([seed, number, *name.encode()])
