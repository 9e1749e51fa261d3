"""Remedies in a sentence: what would have admitted the vehicle, and what would not."""

from collections.abc import Sequence

import numpy as np

from evdash.explain.remedies import NoRemedy, Remedy
from evdash.explain.trials import Trials
from evdash.explain.words import Clock, cents, clock_of, counted, listed

TENTH_KW = 0.1 + 1e-9
MORE = {
    "chargers": "more chargers",
    "headroom": "more headroom",
    "time": "a later return",
    "price": "a higher price",
}


def remedies_told(trials: Trials, remedies: Sequence[Remedy | NoRemedy]) -> str:
    """One sentence: the least changes that would have done, then those that would not."""
    found = [remedy_told(trials, r) for r in remedies if isinstance(r, Remedy)]
    parts = []
    if found:
        parts.append(f"It would have been admitted {listed(found, 'or')}")
    none = [r for r in remedies if isinstance(r, NoRemedy)]
    vain = [_vain(trials, r) for r in none if r.proven]
    if vain:
        parts.append(f"{listed(vain, 'or')} alone would not have helped")
    unknown = [_vain(trials, r) for r in none if not r.proven]
    if unknown:
        parts.append(f"no amount of {listed(unknown, 'or')} was found to help")
    told = "; ".join(parts)
    return f"{told[:1].upper()}{told[1:]}." if told else ""


def remedy_told(trials: Trials, remedy: Remedy) -> str:
    """One remedy, to follow "admitted": `with 2 more chargers`."""
    clock = clock_of(trials)
    amount = remedy.amount
    if remedy.kind == "chargers":
        told = f"with {_more_chargers(round(amount))}"
    elif remedy.kind == "headroom":
        told = f"with {_kw(amount)} more headroom{_too_little(remedy)} "
        told += clock.spans(remedy.intervals)
    elif remedy.kind == "time":
        told = _later(trials, clock, round(amount))
    elif remedy.kind == "price":
        told = f"at a price {cents(amount)}/kWh higher (to within {_margin(remedy)})"
    elif remedy.kind == "amount":
        direction = "more" if amount > 0 else "less"
        told = f"if it had asked for {abs(amount):.2f} kWh {direction}"
    else:
        told = f"if it could take {trials.request.max_kw + amount:.2f} kW"
    return told if remedy.least else f"{told} (the least found)"


def _more_chargers(count: int) -> str:
    return counted(count, "more charger")


def _kw(amount: float) -> str:
    return f"{amount:.1f} kW" if round(amount, 1) == amount else f"{amount:g} kW"


def _too_little(remedy: Remedy) -> str:
    """What is known not to do, where amounts are told in steps coarser than 0.1 kW."""
    if remedy.refused_at <= 0 or remedy.amount - remedy.refused_at < TENTH_KW:
        return ""
    return f" ({_kw(remedy.refused_at)} is not enough)"


def _margin(remedy: Remedy) -> str:
    return f"{cents(remedy.amount - remedy.refused_at)}/kWh"


def _later(trials: Trials, clock: Clock, intervals: int) -> str:
    last = trials.request.deadline_interval + intervals - 1
    told = f"with a return {clock.lasting(intervals)} later, at {clock.end(last)}"
    if last < trials.inputs.scenario.intervals:
        return told
    return f"{told} (beyond the horizon, taken to go on like its last interval)"


def _vain(trials: Trials, none: NoRemedy) -> str:
    told = MORE[none.kind]
    if not np.isfinite(none.most) or none.kind != "time":
        return told
    clock = clock_of(trials)
    return f"{told} (by up to {clock.lasting(round(none.most))})"
