"""Which column of a table of sessions means what: proposed here, confirmed by the user."""

from collections.abc import Mapping, Sequence

from evdash.imports.columns import proposed_by

FIELDS: Mapping[str, str] = {
    "arrival": "when the vehicle came",
    "departure": "when it left",
    "duration": "how long it stayed, if there is no departure",
    "energy_kwh": "energy drawn from the grid, kWh",
    "vehicle": "a name of its own for each session",
    "battery_kwh": "usable battery capacity, kWh",
    "soc_in": "state of charge on arrival, 0 to 1 or percent",
    "soc_out": "state of charge on leaving, 0 to 1 or percent",
    "max_kw": "on-board charger limit, kW",
    "option": "price option chosen",
}
"""What can be taken from a table, and what it is."""
REQUIRED = ("arrival", "energy_kwh")
KNOWN: Mapping[str, Sequence[str]] = {
    "arrival": (
        "arrival", "connectiontime", "pluginTime", "plugintime", "start", "starttime", "startedat",
        "startdatetime", "connectionstartdatetime", "connectiontimestart", "arrivaltime",
        "startplugin", "chargestart", "plugin",
    ),
    "departure": (
        "departure", "disconnecttime", "plugouttime", "end", "endtime", "endtimeprk", "endedat",
        "enddatetime", "connectionenddatetime", "departuretime", "endplugout", "plugout",
    ),
    "duration": (
        "duration", "connectionh", "connectionhours", "durationhours", "durationmin",
        "durationminutes", "durationh", "plugindurationh",
    ),
    "energy_kwh": (
        "energykwh", "kwhdelivered", "requestedenergykwh", "energy", "energyneed", "kwh",
        "elkwh", "energydelivered", "totalenergy", "energydeliveredkwh", "energyaddedkwh",
    ),
    "vehicle": ("sessionid", "session", "chargeeventid", "id", "eventindex", "transactionid"),
    "battery_kwh": ("batterykwh", "energycapacity", "batterycapacity", "batterycapacitykwh"),
    "soc_in": ("socin", "startsoc", "socstart", "arrivalsoc", "soci", "initialsoc"),
    "soc_out": ("socout", "endsoc", "socend", "departuresoc", "socf", "targetsoc"),
    "max_kw": ("maxkw", "maxchargerate", "pevmaxkw", "onboardkw"),
    "option": ("option", "priceoption", "tariff"),
}  # fmt: skip
"""Names columns go by in ACN-Data, EVI-DiST, EVI-Pro and others, without case and signs."""


def proposed(columns: Sequence[str]) -> dict[str, str]:
    """A column for each field whose name is known; a duration only without a departure."""
    found = proposed_by(KNOWN, columns)
    if "departure" in found:
        found.pop("duration", None)
    return found
