"""The scenarios that come with the program."""

from pathlib import Path

PRESETS = Path(__file__).parents[2] / "data" / "presets"
DEFAULT = PRESETS / "summer-weekday"


def bundled_scenarios() -> tuple[Path, ...]:
    """The folders of the bundled scenarios, the default first."""
    others = sorted(path for path in PRESETS.iterdir() if path.is_dir() and path != DEFAULT)
    return (DEFAULT, *others)
