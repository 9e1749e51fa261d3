"""Writes the bundled scenarios in `data/presets/` from the tables in `data/sources/`.

Run `python data/build_presets.py` after changing a table; a test holds both in step.
"""

import csv
import io
import sys
from dataclasses import dataclass
from pathlib import Path

import tomlkit

HERE = Path(__file__).parent


@dataclass(frozen=True)
class Preset:
    """What sets one bundled scenario apart from the others."""

    folder: str
    title: str
    story: str
    date: str
    load: str
    station_node: str = "634"
    chargers: int = 12
    vehicles_per_day: float = 100.0
    intervals: int = 24
    limited_by_transformer: bool = True
    load_scale: float = 1.0


PRESETS = (
    Preset(
        "summer-weekday",
        "Summer weekday",
        "An ordinary day: the 500 kVA transformer at node 634 binds in the evening.",
        "2020-07-15",
        "summer_weekday",
    ),
    Preset(
        "price-spike",
        "Price spike",
        "The heat wave of August 2020: energy above 1 $/kWh from 13:00 to 21:00.",
        "2020-08-18",
        "summer_weekday",
    ),
    Preset(
        "negative-price",
        "Negative prices",
        "A Sunday in June with ten hours of negative prices around noon.",
        "2020-06-07",
        "summer_weekend",
    ),
    Preset(
        "winter-weekday",
        "Winter weekday",
        "Heating gives the load two peaks, at 08:00 and, the higher one, at 20:00.",
        "2020-01-15",
        "winter_weekday",
    ),
    Preset(
        "voltage-limited",
        "Voltage limited",
        "A large station at node 671, loads 8 % higher: the voltage at node 652 binds, "
        "no transformer does.",
        "2020-07-15",
        "summer_weekday",
        station_node="671",
        chargers=140,
        vehicles_per_day=240.0,
        limited_by_transformer=False,
        load_scale=1.08,
    ),
    Preset(
        "past-midnight",
        "Past midnight",
        "The summer weekday with six hours more to charge in: what midnight costs.",
        "2020-07-15",
        "summer_weekday",
        intervals=30,
    ),
)


def source(name: str) -> list[dict[str, str]]:
    """The rows of a table in `data/sources/`."""
    with (HERE / "sources" / name).open(newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def table(header: list[str], rows: list[list[object]]) -> str:
    """A CSV table as text."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()


def nodes_csv() -> str:
    """Spot loads, kvar left to the power factor as in the paper's tests; capacitors on."""
    header = ["node", "load_kw", "load_kvar", "shunt_kvar"]
    header += ["generation_kw", "rating_kva", "x", "y"]
    return table(
        header,
        [
            [row["node"], row["load_kw"], "", row["shunt_kvar"], "", "", row["x"], row["y"]]
            for row in source("ieee13_nodes.csv")
        ],
    )


def lines_csv(limited_by_transformer: bool) -> str:
    """Lines with their ratings; the transformer's is left blank where it is not to bind."""
    rows: list[list[object]] = []
    for line in source("ieee13_lines.csv"):
        rated = limited_by_transformer or line["kind"] != "transformer"
        rating = line["rating_kva"] if rated else ""
        rows.append([line["from_node"], line["to_node"], line["r_ohm"], line["x_ohm"], rating])
    return table(["from_node", "to_node", "r_ohm", "x_ohm", "rating_kva"], rows)


def profile_csv(preset: Preset) -> str:
    """Price and load by hour; a horizon beyond midnight repeats the day's first hours."""
    prices = [row[preset.date] for row in source("caiso_dayahead_prices.csv")]
    loads = [row[preset.load] for row in source("epri_residential_load.csv")]
    return table(
        ["interval", "price_per_kwh", "load_pu", "generation_pu"],
        [[t, prices[t % 24], loads[t % 24], ""] for t in range(preset.intervals)],
    )


def fleet_csv() -> str:
    """US models, their shares in proportion to sales."""
    return table(
        ["model", "share", "battery_kwh", "max_kw"],
        [
            [row["model"], row["us_sales_2024_approx"], row["usable_kwh"], row["onboard_ac_kw"]]
            for row in source("us_fleet.csv")
        ],
    )


def scenario_toml(preset: Preset) -> str:
    """The settings of a preset."""
    settings = {
        "format": 1,
        "name": preset.title,
        "start": f"{preset.date}T00:00",
        "interval_minutes": 60,
        "intervals": preset.intervals,
        "arrivals_until": 24,
        "feeder": {
            "source_node": "650",
            "source_voltage_pu": 1.02,
            "voltage_min_pu": 0.97,
            "voltage_max_pu": 1.03,
            "base_mva": 5.0,
            "base_kv": 4.16,
            "load_scale": preset.load_scale,
            "power_factor": 0.9,
        },
        "station": {
            "node": preset.station_node,
            "chargers": preset.chargers,
            "min_kw": 3.3,
            "max_kw": 19.2,
            "efficiency": 0.9,
        },
        "option": [
            {"name": "C1", "price_per_kwh": 0.35, "average_kw": 9.6},
            {"name": "C2", "price_per_kwh": 0.25, "average_kw": 4.8},
        ],
        "arrivals": {
            "seed": 1,
            "vehicles_per_day": preset.vehicles_per_day,
            "hourly_share": [float(row["weekday"]) for row in source("arrival_share.csv")],
            "option_share": {"C1": 0.4, "C2": 0.6},
            "soc_in_beta": [2.307, 1.664],
            "soc_out": [0.8, 1.0],
            "fleet": "fleet.csv",
        },
    }
    return tomlkit.dumps(settings)


def preset_files(preset: Preset) -> dict[str, str]:
    """The files of one bundled scenario."""
    return {
        "README.md": f"# {preset.title}\n\n{preset.story}\n\n"
        "Written by `data/build_presets.py`; sources are named in `data/README.md`.\n",
        "scenario.toml": scenario_toml(preset),
        "nodes.csv": nodes_csv(),
        "lines.csv": lines_csv(preset.limited_by_transformer),
        "profile.csv": profile_csv(preset),
        "fleet.csv": fleet_csv(),
    }


def main(target: Path) -> None:
    """Write every preset below `target`."""
    for preset in PRESETS:
        folder = target / preset.folder
        folder.mkdir(parents=True, exist_ok=True)
        for name, text in preset_files(preset).items():
            (folder / name).write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE / "presets")
