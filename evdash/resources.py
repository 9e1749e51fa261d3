"""Where what is not code lies: beside the package in a checkout, inside it once installed."""

from pathlib import Path

PACKAGE = Path(__file__).parent
INSTALLED = PACKAGE / "share"
"""Where a wheel puts `data`, `pages`, `app.py` and `.streamlit` (pyproject.toml)."""
HOME = INSTALLED if INSTALLED.is_dir() else PACKAGE.parent
DATA, APP = HOME / "data", HOME / "app.py"
IMPORTABLE_FROM = PACKAGE.parent
"""The working folder from which `python -m evdash…` runs this very code in another process."""
