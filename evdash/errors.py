"""The few errors the program raises on purpose, each with a message meant for a person."""

from collections.abc import Sequence
from dataclasses import dataclass


class EvdashError(Exception):
    """Base of every error evdash raises on purpose."""


LONGEST = 300


def printable(text: str) -> str:
    r"""Text with what no screen shows, or obeys instead, written out: `\x1b`, `\n`, `\u202e`."""
    return "".join(
        c if c.isprintable() else c.encode("unicode_escape", "surrogatepass").decode() for c in text
    )


def legible(text: str) -> str:
    """Text from outside fit for a message: nothing unprintable, and of bounded length."""
    return printable(text if len(text) <= LONGEST else f"{text[: LONGEST - 1]}…")


@dataclass(frozen=True, slots=True)
class Fault:
    """One thing wrong with the input: where it stands, what was found, what is allowed.

    All three are made legible, as they may quote whatever the input holds.
    """

    place: str
    found: str
    allowed: str

    def __post_init__(self) -> None:
        for part in ("place", "found", "allowed"):
            object.__setattr__(self, part, legible(getattr(self, part)))

    def __str__(self) -> str:
        return f"{self.place}: found {self.found}; {self.allowed}"


class InputError(EvdashError):
    """Wrong input. Carries every fault that was found, not only the first."""

    def __init__(self, faults: Sequence[Fault]) -> None:
        self.faults = tuple(faults)
        super().__init__("\n".join(str(fault) for fault in self.faults))


@dataclass(frozen=True, slots=True)
class Shortfall:
    """Energy a contracted vehicle would miss before its promised return."""

    vehicle: str
    missing_kwh: float


class ImpossibleCommitments(EvdashError):
    """A change would break contracts already made. Carries the least possible shortfalls."""

    def __init__(self, shortfalls: Sequence[Shortfall]) -> None:
        self.shortfalls = tuple(shortfalls)
        told = ", ".join(f"{s.vehicle} by {s.missing_kwh:.2f} kWh" for s in self.shortfalls)
        super().__init__(f"contracts would fall short: {told}")


class SolverFailure(EvdashError):
    """The optimiser ended without a usable plan; the message carries its own words."""


class PolicyFault(SolverFailure):
    """A policy from outside gave no plan that can be read; the message says what it did instead."""


class PowerFlowDiverged(EvdashError):
    """The AC power flow found no solution."""


class StoreUnavailable(EvdashError):
    """Runs cannot be kept or read; the message names the file and the reason."""
