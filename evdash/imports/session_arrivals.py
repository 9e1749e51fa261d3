"""Sessions as rows of arrivals.csv: battery, charge and price option of each."""

import math
from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from evdash.domain.arrivals import LOCAL_TIME_FORMAT
from evdash.errors import Fault, InputError
from evdash.files.draft import Row
from evdash.imports.session_rows import Session, SessionRules


def arrival_rows(
    sessions: list[Session], settings: Mapping[str, Any], rules: SessionRules
) -> tuple[tuple[Row, ...], list[str]]:
    """Rows of arrivals.csv and what was assumed for them."""
    station, options = settings.get("station"), settings.get("option")
    efficiency = station.get("efficiency") if isinstance(station, dict) else None
    usable = isinstance(efficiency, int | float) and 0 < efficiency <= 1
    if not usable or not isinstance(options, list) or not options:
        rule = "the scenario should have a station's efficiency and price options"
        raise InputError([Fault("scenario.toml", "neither or one of them", rule)])
    assert efficiency is not None  # noqa: S101 - told above
    averages = sorted((float(o["average_kw"]), str(o["name"])) for o in options)
    chosen, told = _options(sessions, averages, rules)
    enlarged = 0
    rows = []
    for session, option, name in zip(sessions, chosen, _names(sessions), strict=True):
        into_battery = session.energy_kwh * float(efficiency)
        soc_out = rules.soc_out if session.soc_out is None else session.soc_out
        battery = session.battery_kwh or rules.battery_kwh
        if session.soc_in is not None and session.battery_kwh is None and soc_out > session.soc_in:
            battery = into_battery / (soc_out - session.soc_in)
        if into_battery > soc_out * battery:
            battery, enlarged = math.ceil(into_battery / soc_out * 10) / 10, enlarged + 1
        rows.append(
            {
                "vehicle": name,
                "arrival": session.arrival.strftime(LOCAL_TIME_FORMAT),
                "option": option,
                "battery_kwh": repr(battery),
                "soc_in": repr(soc_out - into_battery / battery),
                "soc_out": repr(soc_out),
                "max_kw": "" if session.max_kw is None else repr(session.max_kw),
            }
        )
    told.append(
        f"Energy is what the session drew from the grid; times {efficiency:g} it goes into the "
        f"battery. Where the table has none, batteries are of {rules.battery_kwh:g} kWh and are "
        f"left at {rules.soc_out:.0%}; soc_in follows from the energy."
    )
    if enlarged:
        told.append(f"{enlarged} batteries were enlarged to hold the energy of their session.")
    return tuple(rows), told


def _options(
    sessions: list[Session], averages: list[tuple[float, str]], rules: SessionRules
) -> tuple[list[str], list[str]]:
    """The price option of each session: its own, drawn by shares, or by its average power."""
    names = [name for _, name in averages]
    if rules.option_share:
        shares = [rules.option_share.get(name, 0.0) for name in names]
        if set(rules.option_share) - set(names) or abs(sum(shares) - 1) > 1e-6:
            found = ", ".join(f"{k}={v:g}" for k, v in rules.option_share.items())
            rule = f"should be shares of {', '.join(names)} with sum 1"
            raise InputError([Fault("option share", found, rule)])
        drawn = np.random.default_rng(rules.seed).choice(len(names), len(sessions), p=shares)
        return [names[i] for i in drawn], [f"Options are drawn by shares, seed {rules.seed}."]
    if any(session.option for session in sessions):
        return [session.option for session in sessions], ["Options are the table's."]
    chosen, too_fast, unknown = [], 0, 0
    for session in sessions:
        if session.stay_h is None:
            unknown += 1
            chosen.append(names[-1])
            continue
        needed_kw = session.energy_kwh / max(session.stay_h, 1e-9)
        slowest = next((name for kw, name in averages if kw >= needed_kw), None)
        too_fast += slowest is None
        chosen.append(slowest or names[-1])
    counts = ", ".join(f"{name} {count}" for name, count in sorted(Counter(chosen).items()))
    told = [f"Each session has the slowest option that returns it by when it left: {counts}."]
    if too_fast:
        told.append(
            f"{too_fast} sessions drew more than any option's average power and have {names[-1]}; "
            "they are returned later than they left."
        )
    if unknown:
        told.append(f"{unknown} sessions without a departure have {names[-1]}.")
    return chosen, told


def _names(sessions: list[Session]) -> list[str]:
    """Sessions' own names where all are fit and different, else S-0001 and on."""
    own = [session.name for session in sessions]
    fit = all(name and name[0].isalnum() and name.isprintable() and len(name) <= 60 for name in own)
    if fit and len(set(own)) == len(own):
        return own
    return [f"S-{number:04d}" for number in range(1, len(own) + 1)]
