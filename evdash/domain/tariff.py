"""What the station pays for energy: the one place where a schedule turns into money.

A new component of what it pays or earns is a field of `Tariff`, filled in `Scenario.tariff`. What
is so much a kWh, as a tax, is added in `cost`, `cost_per_kw` (which every program reads: the
paper's, the fast one, and those that choose among plans of equal worth), `least_cost`,
`most_apart`, `most_saved_per_kwh` and `mean_price`. What is not, as a demand rate, is a term of
`cost`, of `energy_cost` in `evdash/scheduling/equations.py` and of `program_of` in
`evdash/scheduling/fast/relaxation.py`, and bounds that look at prices alone have to know of it.
The audit, which referees all this, does its own sums (`grep price_per_kwh evdash/audit`), and finds
fault until it knows. What drivers pay is `Request.pays`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from evdash.domain.digest import digest
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
        return replace(self, price_per_kwh=self.price_per_kwh[slots])

    def followed_by(self, others: Sequence["Tariff"]) -> "Tariff":
        """This tariff, and the slots of others after its own."""
        prices = [one.price_per_kwh for one in (self, *others)]
        return replace(self, price_per_kwh=np.concatenate(prices))

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
        return replace(self, price_per_kwh=self.price_per_kwh + more_per_kwh)

    def is_same(self, other: "Tariff") -> bool:
        """Whether both ask the same of every schedule."""
        return digest(self) == digest(other)
