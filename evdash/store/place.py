"""Where runs are kept: outside the program's own folder."""

import os
from pathlib import Path

import platformdirs

VARIABLE = "EVDASH_STORE"


def store_directory() -> Path:
    """The folder `EVDASH_STORE` names, or else the user's folder for data that programs keep."""
    named = os.environ.get(VARIABLE, "").strip()
    return Path(named).expanduser() if named else platformdirs.user_data_path("evdash", False)
