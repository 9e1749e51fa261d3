"""What the station pays for energy: the one place where a schedule turns into money.

A new component of what it pays or earns, an export price or a demand rate, is a field of `Tariff`,
filled in `Scenario.tariff`, and a term of `cost`. Where schedules are chosen the same term stands
in `energy_cost` of `evdash/scheduling/equations.py`, as the paper writes it, and in `program_of`
of `evdash/scheduling/fast/relaxation.py`. What drivers pay is `Request.pays`.
The checker and the audit, which referee all this, do their own sums.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from evdash.domain.limits import Floats


@dataclass(frozen=True, slots=True)
class Tariff:
    """What energy costs over a row of slots: the c of (P1) and its Δt.

    Parameters
    ----------
    price_per_kwh : (slots,)
        Price of energy drawn from the grid in each slot, $/kWh; may be negative.
    interval_hours : float
        Length of a slot, h.
    """

    price_per_kwh: Floats
    interval_hours: float

    def __len__(self) -> int:
        return len(self.price_per_kwh)

    def __getitem__(self, slots: slice | NDArray[np.intp]) -> "Tariff":
        """The same tariff over some of its slots, in the order asked for."""
        return Tariff(self.price_per_kwh[slots], self.interval_hours)

    def cost(self, power_kw: Floats) -> float:
        """What the energy of a schedule costs: the first term of (P1), Σ c·P·Δt.

        Parameters
        ----------
        power_kw : (slots,) or (vehicles, slots)
            Power drawn from the grid, kW: of one vehicle, of the station, or of each vehicle.

        Returns
        -------
        float
            Cost in $; negative where prices are.
        """
        total_kw = np.atleast_2d(power_kw).sum(axis=0)
        return float(self.price_per_kwh @ total_kw) * self.interval_hours

    @property
    def cost_per_kw(self) -> Floats:
        """What a kW held throughout a slot costs, $/kW, (slots,): P's coefficient in (P1), c·Δt."""
        return self.price_per_kwh * self.interval_hours

    def least_cost(self, power_kw: Floats) -> float:
        """What these powers cost at least, each in a slot of its own, $.

        `power_kw` (at most slots,), kW, highest first: the highest goes to the cheapest slot.
        """
        cheapest = np.sort(self.price_per_kwh)[: len(power_kw)]
        return float(cheapest @ power_kw) * self.interval_hours

    def most_apart(self, energy_kwh: float) -> float:
        """More than what so much energy costs can differ between two schedules, $."""
        return 2 * float(np.abs(self.price_per_kwh).max()) * energy_kwh

    @property
    def most_saved_per_kwh(self) -> float:
        """What a kWh can save at most in another slot, $/kWh."""
        return float(np.ptp(self.price_per_kwh))

    def mean_price(self, power_kw: Floats) -> float:
        """What a kWh of a schedule (slots,), in kW, costs in the mean, $/kWh."""
        return float(power_kw @ self.price_per_kwh / power_kw.sum())

    def dearer_by(self, more_per_kwh: Floats) -> "Tariff":
        """The tariff with so much on every slot's price, (slots,), $/kWh."""
        return Tariff(self.price_per_kwh + more_per_kwh, self.interval_hours)

    def is_same(self, other: "Tariff") -> bool:
        """Whether both ask the same of every schedule."""
        return self.interval_hours == other.interval_hours and np.array_equal(
            self.price_per_kwh, other.price_per_kwh
        )
