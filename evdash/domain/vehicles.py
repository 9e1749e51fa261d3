"""Vehicles asking for a charge, and the contracts some of them get."""

from dataclasses import dataclass, replace
from datetime import datetime
from typing import Self

from evdash.domain.refusal import GivenOrNone

DRAWN, GUEST = "PEV-", "Guest-"
"""What names begin with of those the generator draws, and of those who come beside all others."""
ENERGY_TOLERANCE_KWH = 1e-6
"""Energy that counts as nothing: what floating point leaves over."""


@dataclass(frozen=True, slots=True)
class Request:
    """A vehicle at the door: what it needs, by when, at which price.

    `deadline_interval` is the first interval in which it may no longer charge, clipped at
    the end of the horizon. `refusal` is the reason why no schedule whatever could serve
    it, or None.
    """

    vehicle: str
    option: str
    arrival: datetime
    arrival_interval: int
    deadline_interval: int
    need_kwh: float
    price_per_kwh: float
    min_kw: float
    max_kw: float
    battery_kwh: float
    soc_in: float
    soc_out: float
    refusal: GivenOrNone = None

    def pays(self, energy_kwh: float) -> float:
        """What its driver pays for so much energy, $, by the terms of the price option."""
        return self.price_per_kwh * energy_kwh

    @property
    def revenue(self) -> float:
        """What its driver pays in full, $."""
        return self.pays(self.need_kwh)

    def paying_more(self, usd_per_kwh: float) -> Self:
        """The same request at so much more for every kWh."""
        return replace(self, price_per_kwh=self.price_per_kwh + usd_per_kwh)

    def with_bonus(self, usd: float) -> Self:
        """The same request with so much on top of what its driver pays in full."""
        return self.paying_more(usd / self.need_kwh)


@dataclass(frozen=True, slots=True)
class Contract:
    """A promise: the request's energy, complete before its deadline.

    `request` holds the terms in force. Where an event took away what they need, they are the
    terms that can still be kept and `short_kwh` is what the promise was for beyond them.
    """

    request: Request
    delivered_kwh: float = 0.0
    short_kwh: float = 0.0

    @property
    def vehicle(self) -> str:
        return self.request.vehicle

    @property
    def owed_kwh(self) -> float:
        """Energy still to come, kWh; the paper's s_n at this interval."""
        return max(0.0, self.request.need_kwh - self.delivered_kwh)

    @property
    def promised_kwh(self) -> float:
        """The whole promise, kept or not, kWh."""
        return self.request.need_kwh + self.short_kwh

    @property
    def is_short(self) -> bool:
        return self.short_kwh > ENERGY_TOLERANCE_KWH

    @property
    def is_fulfilled(self) -> bool:
        return self.owed_kwh <= ENERGY_TOLERANCE_KWH

    def charged(self, energy_kwh: float) -> Self:
        """The contract after `energy_kwh` more has been delivered."""
        return replace(self, delivered_kwh=self.delivered_kwh + energy_kwh)
