"""The scenarios that come with the program."""

from pathlib import Path

from evdash.resources import DATA

PRESETS = DATA / "presets"
DEFAULT = PRESETS / "summer-weekday"
STUDIES = DATA / "studies"


def bundled_scenarios() -> tuple[Path, ...]:
    """The folders of the bundled scenarios, the default first."""
    others = sorted(path for path in PRESETS.iterdir() if path.is_dir() and path != DEFAULT)
    return (DEFAULT, *others)


def located(place: str | Path, beside: Path | None = None) -> Path:
    """Where a scenario lies: a folder or .zip seen from `beside`, or else the bundled one so named.

    What is neither is given back as it stands, for whoever reads it to tell.
    """
    path = beside / place if beside else Path(place)
    names = {folder.name: folder for folder in bundled_scenarios()}
    return path if is_there(path) else names.get(str(place), path)


def located_study(place: str | Path) -> Path:
    """Where a study file lies, or else the bundled one so named."""
    names = {path.stem: path for path in STUDIES.glob("*.toml")}
    return Path(place) if is_there(Path(place)) else names.get(str(place), Path(place))


def is_there(place: Path) -> bool:
    """Whether there is such a place; a name that no file can have is none."""
    try:
        return place.exists()
    except (OSError, ValueError):
        return False
