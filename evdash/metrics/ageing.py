"""Thermal ageing of a transformer by the loading guide IEEE C57.91: hot spot and loss of life.

The guide's top-oil model: oil follows the load with a time constant of hours, the winding's
hottest spot follows the oil's with one of minutes, and insulation ages by Arrhenius' law.
"""

from dataclasses import dataclass

import numpy as np

from evdash.domain.limits import Floats

ZERO_C_K = 273.0
"""As the guide rounds it."""
REFERENCE_K = 383.0
"""110 °C, the hot spot at which life is normal."""
AGEING_K = 15_000.0
STEPS_PER_HOUR = 60
"""The hot spot is followed by the minute: its own time constant is about five."""
MOST_CYCLES = 400
SETTLED_K = 1e-9


@dataclass(frozen=True, slots=True)
class Thermal:
    """What is assumed of a transformer: by default oil-immersed, self-cooled (ONAN), 65 K rise.

    `loss_ratio`: load loss at rated load over no-load loss, the guide's R. `oil_exponent` is
    its n, `winding_exponent` its m. Rises at rated load: `top_oil_rise_k` over ambient,
    `hot_spot_rise_k` over top oil. `life_hours` is the guide's normal insulation life.
    """

    ambient_c: float = 30.0
    top_oil_rise_k: float = 55.0
    hot_spot_rise_k: float = 25.0
    loss_ratio: float = 5.0
    oil_exponent: float = 0.8
    winding_exponent: float = 0.8
    oil_hours: float = 3.0
    winding_hours: float = 0.08
    life_hours: float = 180_000.0


@dataclass(frozen=True, slots=True)
class Ageing:
    """A transformer's hot spot over the horizon, °C at the middle of each minute, (minutes,).

    `equivalent_factor` is the guide's F_EQA: how many hours of normal life an hour costs.
    """

    hot_spot_c: Floats
    equivalent_factor: float
    hours: float
    life_hours: float

    @property
    def highest_c(self) -> float:
        return float(self.hot_spot_c.max())

    @property
    def life_lost_hours(self) -> float:
        """Hours of normal insulation life the horizon has cost."""
        return self.equivalent_factor * self.hours

    @property
    def life_lost_percent(self) -> float:
        """Loss of life in per cent of normal insulation life."""
        return 100 * self.life_lost_hours / self.life_hours


def ageing_factor(hot_spot_c: Floats) -> Floats:
    """F_AA = exp(15000/383 − 15000/(θ_H + 273)): 1 at 110 °C, twice as much about 7 K hotter."""
    return np.asarray(np.exp(AGEING_K / REFERENCE_K - AGEING_K / (hot_spot_c + ZERO_C_K)))


def ageing(
    load_kva: Floats, rating_kva: float, interval_hours: float, thermal: Thermal | None = None
) -> Ageing:
    """Ageing under a load (intervals,), each interval's mean, that comes again and again.

    The horizon begins as warm as it ends, so that its result does not hang on a temperature
    nobody knows.
    """
    thermal = thermal or Thermal()
    load = np.asarray(load_kva, dtype=float) / rating_kva
    oil, winding = ultimate_rises(load, thermal)
    start = np.array([oil[0], winding[0]])
    for _ in range(MOST_CYCLES):
        hot_spot_c, end = _followed(oil, winding, start, interval_hours, thermal)
        if np.abs(end - start).max() <= SETTLED_K:
            break
        start = end
    return Ageing(
        hot_spot_c=hot_spot_c,
        equivalent_factor=float(ageing_factor(hot_spot_c).mean()),
        hours=len(load) * interval_hours,
        life_hours=thermal.life_hours,
    )


def ultimate_rises(load: Floats, thermal: Thermal) -> tuple[Floats, Floats]:
    """Where top oil over ambient and hot spot over top oil would settle, K, for loads per rating.

    Δθ_TO,U = Δθ_TO,R · ((K²·R + 1)/(R + 1))ⁿ and Δθ_H,U = Δθ_H,R · K²ᵐ.
    """
    ratio = (load**2 * thermal.loss_ratio + 1) / (thermal.loss_ratio + 1)
    oil = thermal.top_oil_rise_k * ratio**thermal.oil_exponent
    winding = thermal.hot_spot_rise_k * load ** (2 * thermal.winding_exponent)
    return np.asarray(oil), np.asarray(winding)


def oil_time_constant(ultimate_k: float, initial_k: float, thermal: Thermal) -> float:
    """τ_TO in h for a change between two rises; the rated one where n is 1 or nothing changes."""
    n, rated = thermal.oil_exponent, thermal.top_oil_rise_k
    u, i = ultimate_k / rated, initial_k / rated
    if n == 1.0 or abs(u - i) < 1e-9:
        return thermal.oil_hours
    return float(thermal.oil_hours * (u - i) / (u ** (1 / n) - i ** (1 / n)))


def _followed(
    oil: Floats, winding: Floats, start: Floats, interval_hours: float, thermal: Thermal
) -> tuple[Floats, Floats]:
    """Hot spot by the minute, and the two rises at the end, from those at the start."""
    steps = max(1, round(interval_hours * STEPS_PER_HOUR))
    middle = (np.arange(steps) + 0.5) * interval_hours / steps
    rises, hot_spots = start, []
    for ultimate in np.column_stack([oil, winding]):
        constants = np.array(
            [
                oil_time_constant(float(ultimate[0]), float(rises[0]), thermal),
                thermal.winding_hours,
            ]
        )
        left = np.exp(-middle[:, None] / constants)
        hot_spots.append(thermal.ambient_c + (ultimate + (rises - ultimate) * left).sum(axis=1))
        rises = ultimate + (rises - ultimate) * np.exp(-interval_hours / constants)
    return np.concatenate(hot_spots), rises
