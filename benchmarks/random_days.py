"""Days nobody tuned to: random feeders, clocks, chargers, options, prices and arrivals."""

from datetime import datetime, timedelta
from typing import Any

import numpy as np

from evdash.domain.scenario import Scenario
from evdash.files.validate import validate

MINUTES = (5, 6, 10, 12, 15, 15, 15, 20, 30, 30, 60, 60, 60, 60)
MIN_KW = (0.0, 1.4, 3.3, 3.3, 6.0)
MAX_KW = (6.0, 7.4, 11.0, 19.2)
ONBOARD_KW = (2.3, 3.7, 6.6, 7.2, 11.0, 11.5, 22.0)
BATTERY_KWH = (1.5, 9.0, 14.0, 39.0, 57.5, 75.0, 109.0)


def random_scenario(seed: int) -> Scenario:
    """A random scenario, the same for the same seed; always one a user could have given."""
    rng = np.random.default_rng(seed)
    minutes = int(rng.choice(MINUTES))
    hours = rng.uniform(3, 30) if minutes >= 15 else rng.uniform(2, 8)
    intervals = max(1, round(hours * 60 / minutes))
    station, room_kw = _station(rng)
    feeder = _feeder(rng, room_kw)
    return validate(
        {
            "format": 1,
            "name": f"random day {seed}",
            "start": datetime(2021, 3, 1) + timedelta(minutes=int(rng.integers(0, 2 * 24 * 60))),
            "interval_minutes": minutes,
            "intervals": intervals,
            "arrivals_until": round(intervals * rng.choice([0.6, 0.8, 1.0])),
            "station": station | {"node": feeder.pop("station_node")},
            "option": (options := _options(rng, station["max_kw"])),
            "arrivals": _arrivals(rng, [option["name"] for option in options]),
            "profile": _profile(rng, intervals),
        }
        | feeder
    )


def _station(rng: np.random.Generator) -> tuple[dict[str, Any], float]:
    """The station, and feeder room that is now ample, now scarce for its chargers, in kW."""
    min_kw = float(rng.choice(MIN_KW))
    max_kw = float(rng.choice([kw for kw in MAX_KW if kw >= min_kw]))
    chargers = int(rng.integers(0, 13))
    station = {
        "chargers": chargers,
        "min_kw": min_kw,
        "max_kw": max_kw,
        "efficiency": round(float(rng.uniform(0.8, 1.0)), 3),
    }
    return station, max(1, chargers) * max_kw * float(rng.uniform(0.1, 1.3))


def _feeder(rng: np.random.Generator, room_kw: float) -> dict[str, Any]:
    """A random tree whose loads fill it more or less; every kind of limit can come to bind."""
    size = int(rng.integers(1, 12))
    names = ["source", *(f"n{i}" for i in range(size))]
    load_kw = rng.uniform(0, 2 * room_kw / size, size)
    nodes: list[dict[str, Any]] = [{"node": "source"}]
    lines: list[dict[str, Any]] = []
    station = int(rng.integers(0, size))
    for i, name in enumerate(names[1:]):
        node = {"node": name, "load_kw": float(load_kw[i]), "load_kvar": None}
        if rng.random() < 0.3:
            node |= {"generation_kw": float(rng.uniform(0, 3 * load_kw[i]))}
        if rng.random() < 0.3:
            node |= {"shunt_kvar": float(rng.uniform(0, load_kw[i])), "load_kvar": 0.0}
        if i == station and rng.random() < 0.5:
            node |= {"rating_kva": float(load_kw[i] * 1.2 + room_kw)}
        nodes.append(node)
        upstream = names[int(rng.integers(max(0, i - 2), i + 1))]
        rating = float(1.2 * load_kw.sum() + room_kw) if rng.random() < 0.4 else None
        impedance = {"r_ohm": float(rng.uniform(0.001, 0.3)), "x_ohm": float(rng.uniform(0, 0.4))}
        lines.append({"from_node": upstream, "to_node": name, "rating_kva": rating} | impedance)
    return {
        "feeder": {
            "source_node": "source",
            "source_voltage_pu": float(rng.uniform(0.99, 1.04)),
            "voltage_min_pu": float(rng.choice([0.9, 0.95, 0.97])),
            "voltage_max_pu": 1.05,
            "base_mva": float(rng.choice([1.0, 5.0])),
            "base_kv": float(rng.choice([0.4, 4.16, 12.47], p=[0.1, 0.7, 0.2])),
            "load_scale": float(rng.choice([0.5, 1.0, 1.1])),
            "power_factor": float(rng.choice([0.9, 0.95, 1.0])),
        },
        "nodes": nodes,
        "lines": lines,
        "station_node": names[1:][station],
    }


def _options(rng: np.random.Generator, max_kw: float) -> list[dict[str, Any]]:
    """One to four price options; their average rates may be anything up to the charger's own."""
    return [
        {
            "name": f"C{i + 1}",
            "price_per_kwh": round(float(rng.uniform(0.0, 0.6)), 3),
            "average_kw": round(float(rng.uniform(0.2, 1.0) * max_kw), 2),
        }
        for i in range(int(rng.integers(1, 5)))
    ]


def _arrivals(rng: np.random.Generator, options: list[str]) -> dict[str, Any]:
    models = int(rng.integers(1, 5))
    low = float(rng.uniform(0.3, 0.9))
    return {
        "seed": int(rng.integers(0, 2**31)),
        "vehicles_per_day": float(rng.choice([0, 20, 60, 120, 200], p=[0.02, 0.2, 0.4, 0.28, 0.1])),
        "hourly_share": rng.dirichlet(np.ones(24) * 2).tolist(),
        "option_share": dict(
            zip(options, rng.dirichlet(np.ones(len(options))).tolist(), strict=True)
        ),
        "soc_in_beta": [float(rng.uniform(1, 3)), float(rng.uniform(1, 3))],
        "soc_out": [low, float(rng.uniform(low, 1.0))],
        "fleet": [
            {
                "model": f"model {i}",
                "share": float(rng.uniform(0.1, 1)),
                "battery_kwh": float(rng.choice(BATTERY_KWH)),
                "max_kw": float(rng.choice(ONBOARD_KW)),
            }
            for i in range(models)
        ],
    }


def _profile(rng: np.random.Generator, intervals: int) -> list[dict[str, Any]]:
    """Prices of either sign, at times flat, at times above what any option pays."""
    level, swing = rng.uniform(-0.05, 0.2), rng.choice([0.0, 0.05, 0.3])
    price = np.round(level + swing * rng.standard_normal(intervals), 4)
    load = np.clip(0.6 + 0.4 * np.sin(np.linspace(0, 6, intervals)) * rng.uniform(-1, 1), 0, None)
    return [
        {
            "interval": t,
            "price_per_kwh": float(price[t]),
            "load_pu": float(load[t]),
            "generation_pu": float(rng.uniform(0, 1)),
        }
        for t in range(intervals)
    ]
