"""Hour-by-hour admission and scheduling of electric vehicles on a radial feeder.

`evdash.load("summer-weekday").run()` is a day; docs/api.md has all of it.
"""

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from evdash.api import (
        Comparison,
        Day,
        EvdashError,
        InputError,
        Race,
        Scenario,
        Study,
        compare,
        load,
        study,
    )

__version__ = "0.1.0"
__all__ = [
    "Comparison",
    "Day",
    "EvdashError",
    "InputError",
    "Race",
    "Scenario",
    "Study",
    "compare",
    "load",
    "study",
]


def __getattr__(name: str) -> object:
    """What the library offers, imported when first asked for: the bare package stays light."""
    if name in __all__:
        return getattr(import_module("evdash.api"), name)
    raise AttributeError(f"module 'evdash' has no attribute {name!r}")


def __dir__() -> list[str]:
    return [*globals(), *__all__]
