"""Who comes: vehicles on file, or what is known of those that are drawn; and local times."""

from datetime import datetime
from typing import Annotated, Any

from pydantic import BeforeValidator, Discriminator, Field, PlainSerializer, Tag

from evdash.domain.fields import (
    LARGE,
    SMALL,
    Count,
    Name,
    Number,
    OptionalNumber,
    Record,
    declare,
    declare_optional,
)

LOCAL_TIME_FORMAT = "%Y-%m-%dT%H:%M"
FIRST_YEAR, LAST_YEAR = 1900, 2999
MOST_MODELS, MOST_VEHICLES = 10_000, 100_000
"""Sizes beyond which a day would fill the memory of an ordinary machine."""


def _local_time(value: object) -> object:
    """Read `YYYY-MM-DDTHH:MM`; a TOML date-time passes if it names a whole minute."""
    moment = value
    if isinstance(value, str):
        try:
            moment = datetime.strptime(value.strip(), LOCAL_TIME_FORMAT)
        except ValueError:
            moment = None
    if not isinstance(moment, datetime):
        raise ValueError("should be a local time as YYYY-MM-DDTHH:MM")
    if moment.tzinfo is not None:
        raise ValueError("should be a local time without time zone")
    if moment.second or moment.microsecond:
        raise ValueError("should be a whole minute")
    if not FIRST_YEAR <= moment.year <= LAST_YEAR:
        raise ValueError(f"should be in a year from {FIRST_YEAR} to {LAST_YEAR}")
    return moment


LocalTime = Annotated[
    datetime,
    BeforeValidator(_local_time),
    PlainSerializer(lambda moment: moment.strftime(LOCAL_TIME_FORMAT), str, when_used="json"),
]


class FleetModel(Record):
    """A row of `fleet.csv`: one vehicle model the generator draws from."""

    model: Name = declare("Name of the vehicle model", "", "Leaf")
    share: float = declare("How often it comes, relative to the others", "", 1.0, ge=0, le=LARGE)
    battery_kwh: float = declare("Usable battery capacity", "kWh", 39.0, ge=0.1, le=10_000)
    max_kw: float = declare("On-board charger limit", "kW", 6.6, ge=SMALL, le=LARGE)


class Arrival(Record):
    """A row of `arrivals.csv`: one vehicle asking for a charge."""

    vehicle: Name = declare("Name of the vehicle", "", "PEV-001")
    arrival: LocalTime = declare(
        "Arrival: HH:MM (first at or after the start) or YYYY-MM-DDTHH:MM",
        "",
        datetime(2020, 7, 15),
    )
    option: Name = declare("Price option the driver chose", "", "C1")
    battery_kwh: float = declare("Usable battery capacity", "kWh", 60.0, ge=0.1, le=10_000)
    soc_in: float = declare("State of charge on arrival", "0 to 1", 0.4, ge=0, le=1)
    soc_out: float = declare("State of charge wanted on return", "0 to 1", 0.8, ge=0, le=1)
    max_kw: OptionalNumber = declare_optional("On-board charger limit", "kW", ge=SMALL, le=LARGE)


BetaParameter = Annotated[Number, Field(ge=SMALL, le=1000)]


class ArrivalStatistics(Record):
    """What is known of arrivals before they happen: the generator's keys but its seed."""

    vehicles_per_day: Number = declare(
        "Mean number of vehicles arriving in 24 hours", "vehicles", 100.0, ge=0, le=1_000_000
    )
    hourly_share: tuple[Annotated[Number, Field(ge=0, le=LARGE)], ...] = declare(
        "Relative share of arrivals in each clock hour, 00 to 23 (scaled to sum 1)",
        "",
        (1.0,) * 24,
        min_length=24,
        max_length=24,
    )
    option_share: dict[str, Annotated[Number, Field(ge=0, le=1)]] = declare(
        "Share of drivers choosing each price option; sum 1", "", {}
    )
    soc_in_beta: tuple[BetaParameter, BetaParameter] = declare(
        "Beta distribution of the state of charge on arrival, [a, b]", "", (2.3, 1.7)
    )
    soc_out: tuple[
        Annotated[Number, Field(ge=0.01, le=1)], Annotated[Number, Field(ge=0.01, le=1)]
    ] = declare("Range of the state of charge wanted, [low, high]", "0 to 1", (0.8, 1.0))
    fleet: tuple[FleetModel, ...] = declare(
        "Vehicle models drawn from", "", (), min_length=1, max_length=MOST_MODELS
    )


class GeneratedArrivals(ArrivalStatistics):
    """Arrivals drawn at random: the statistics and a seed."""

    seed: Count = declare("Seed of the random arrivals", "", 1, ge=0, le=2**63 - 1)


class RecordedArrivals(Record):
    """Arrivals given one by one, and what a policy may know of their statistics."""

    vehicles: tuple[Arrival, ...] = Field(default=(), max_length=MOST_VEHICLES)
    seed: Count | None = declare_optional("Seed of what a policy samples", "", ge=0, le=2**63 - 1)
    forecast: ArrivalStatistics | None = None


def _arrivals_kind(value: Any) -> str:
    recorded = "vehicles" in value if isinstance(value, dict) else hasattr(value, "vehicles")
    return "recorded" if recorded else "generated"


Arrivals = Annotated[
    Annotated[GeneratedArrivals, Tag("generated")] | Annotated[RecordedArrivals, Tag("recorded")],
    Discriminator(_arrivals_kind),
]
