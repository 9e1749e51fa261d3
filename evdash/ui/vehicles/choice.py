"""Which vehicles are listed, and in what order. No Streamlit in here."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from evdash.metrics.records import VehicleRecord

GROUPS = ("All", "Admitted", "Refused", "Charging now", "Completed")
_DIGITS = re.compile(r"(\d+)")


@dataclass(frozen=True, slots=True)
class Choice:
    """What somebody wants to see: one of GROUPS, options (none: all), text, one of ORDERS."""

    group: str = GROUPS[0]
    options: tuple[str, ...] = ()
    text: str = ""
    order: str = "Arrival"


def chosen(
    records: Sequence[VehicleRecord], charging_kw: Mapping[str, float], choice: Choice
) -> tuple[VehicleRecord, ...]:
    """The records that answer to a choice, in its order."""
    text = choice.text.strip().casefold()
    kept = [
        record
        for record in records
        if _is_in(record, choice.group, charging_kw)
        and (not choice.options or record.request.option in choice.options)
        and text in f"{record.vehicle}\n{record.why_not}".casefold()
    ]
    return tuple(sorted(kept, key=ORDERS[choice.order]))


def _is_in(record: VehicleRecord, group: str, charging_kw: Mapping[str, float]) -> bool:
    return {
        "All": True,
        "Admitted": record.status != "refused",
        "Refused": record.status == "refused",
        "Charging now": record.vehicle in charging_kw,
        "Completed": record.status == "charged",
    }[group]


def by_name(name: str) -> list[Any]:
    """`PEV-9` before `PEV-10`: text and numbers in turn."""
    return [int(part) if part.isdigit() else part.casefold() for part in _DIGITS.split(name)]


ORDERS: Mapping[str, Callable[[VehicleRecord], Any]] = {
    "Arrival": lambda r: (r.request.arrival, by_name(r.vehicle)),
    "Deadline": lambda r: (r.request.deadline_interval, r.request.arrival),
    "Energy asked": lambda r: (-r.request.need_kwh, r.request.arrival),
    "Revenue": lambda r: (-r.revenue, r.request.arrival),
    "Name": lambda r: by_name(r.vehicle),
}
