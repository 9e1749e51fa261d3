"""`--set KEY=VALUE` as people and scripts might type it."""

import numpy as np

from benchmarks.fuzzing.values import field_of, hostile_text, pick, value_for
from evdash.domain.scenario import Scenario

KEYS = (
    *("station.chargers", "station.node", "station.min_kw", "station.max_kw", "station.efficiency"),
    *("feeder.source_node", "feeder.base_kv", "feeder.load_scale", "feeder.power_factor"),
    *("option.C1.price_per_kwh", "option.C1.name", "option.C9.name", "option", "option.C1"),
    *("arrivals.seed", "arrivals.vehicles_per_day", "arrivals.option_share.C1", "arrivals.fleet"),
    *("arrivals.hourly_share", "arrivals.soc_out", "arrivals.soc_in_beta", "arrivals.file"),
    *("arrivals.forecast.seed", "arrivals.forecast.fleet", "arrivals", "start", "name", "format"),
    *("interval_minutes", "intervals", "arrivals_until", "nodes", "profile", "events", "lines"),
    *("", ".", "..", "station.", ".chargers", "station.chargers.x", "station..chargers", "a.b.c.d"),
)
VALUES = (
    *("0", "-1", "8", "1e3", "0.5", "inf", "nan", "true", "[]", "{}", "[1,2]", "{a=1}", "'x'"),
    *('"x"', "''", "2024-05-06T00:00:00", "00:00", "[" * 400, "{a=" * 400, "9" * 5000, "1 # c"),
    *("1\nformat = 2", "a = 1", "=", "0x1F", "1_0", "C1", "634", "[0.8, 1.0]", "[[1]]", ""),
)


def spoilt_settings(rng: np.random.Generator) -> list[str]:
    """One to three settings, of which any may be right."""
    return [_one(rng) for _ in range(int(rng.integers(1, 4)))]


def _one(rng: np.random.Generator) -> str:
    key = str(pick(rng, KEYS)) if rng.random() < 0.9 else hostile_text(rng)
    if rng.random() < 0.5:
        value = str(pick(rng, VALUES))
    else:
        way = tuple(part for part in key.split(".") if part not in ("C1", "C9"))
        value = str(value_for(rng, field_of(Scenario, way)))
    return f"{key}{'=' if rng.random() < 0.97 else ''}{value}"
