"""Which column of a table by time holds the price, the load or the generation, and its unit."""

from collections.abc import Mapping, Sequence

from evdash.imports.columns import plain_name, proposed_by

FIELDS: Mapping[str, str] = {
    "time": "date and time",
    "price": "energy price",
    "load": "load of the network",
    "generation": "generation in the network",
}
"""What can be taken from a table, and what it is."""
REQUIRED = ("time",)
TARGETS: Mapping[str, str] = {
    "price": "price_per_kwh",
    "load": "load_pu",
    "generation": "generation_pu",
}
"""The columns of profile.csv that values go to."""
PRICE_UNITS: Mapping[str, float] = {"$/kWh": 1.0, "$/MWh": 1e-3, "ct/kWh": 1e-2}
POWER_UNITS: Mapping[str, float] = {"kW": 1.0, "MW": 1e3, "pu": 1.0}
UNITS: Mapping[str, Mapping[str, float]] = {
    "price": PRICE_UNITS,
    "load": POWER_UNITS,
    "generation": POWER_UNITS,
}
"""Units by field and what one of them is in $/kWh or kW; pu is of the peak already."""
ENDINGS = (
    "", "kw", "mw", "pu", "kwh", "mwh", "ctkwh", "usdkwh", "usdmwh", "eurkwh", "eurmwh",
    "perkwh", "permwh", "ctperkwh", "usdperkwh", "usdpermwh", "eurperkwh", "eurpermwh",
    "centsperkwh",
)  # fmt: skip
NAMES: Mapping[str, Sequence[str]] = {
    "time": (
        "time", "timestamp", "datetime", "intervalstart", "start", "starttime", "from",
        "utctimestamp", "localtime", "timeutc", "datetimeutc", "datetimelocal", "hourbeginning",
        "datetimebeginningept", "datetimebeginningutc", "intervalstarttimegmt", "mtucetcest",
        "mtuutc", "mtu", "datumvon", "hourending", "intervalend", "date",
    ),
    "price": (
        "price", "energyprice", "lmp", "totallmpda", "dayaheadprice", "spotprice", "dayahead",
        "rate",
    ),
    "load": ("load", "demand", "consumption", "totalload", "actualtotalload", "power"),
    "generation": ("generation", "pv", "solar", "wind", "pvgeneration", "solargeneration"),
}  # fmt: skip
"""Names columns go by, without case, signs and, of values, the unit at the end."""
KNOWN: Mapping[str, Sequence[str]] = {
    field: tuple(name + end for name in names for end in (ENDINGS if field in UNITS else ("",)))
    for field, names in NAMES.items()
}


def proposed(columns: Sequence[str]) -> dict[str, str]:
    """A column for each field whose name is known."""
    return proposed_by(KNOWN, columns)


def looks_like_profile(columns: Sequence[str]) -> bool:
    """Whether a table's columns seem to be values by time."""
    found = proposed(columns)
    return "time" in found and any(field in found for field in TARGETS)


def proposed_unit(field: str, column: str) -> str | None:
    """The unit that a column's name ends on; None where it names none."""
    name = plain_name(column)
    if field == "price":
        if name.endswith("mwh"):
            return "$/MWh"
        if name.endswith(("ctkwh", "ctperkwh", "centsperkwh")):
            return "ct/kWh"
        return "$/kWh" if name.endswith("kwh") else None
    return next((unit for unit in POWER_UNITS if name.endswith(unit.lower())), None)
