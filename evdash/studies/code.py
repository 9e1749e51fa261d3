"""Which code a result comes from: a result of other code is never taken for one of this."""

import hashlib
import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version

from evdash.resources import INSTALLED, PACKAGE

NOT_BEARING = ("api", "ui", "charts", "cli", "store", "explain", "audit", INSTALLED.name)
"""Parts of the program no result of a study comes from."""
PACKAGES = ("numpy", "scipy", "highspy", "pulp", "power-grid-model", "pandapower", "pydantic")


@lru_cache(maxsize=1)
def code_version() -> str:
    """A digest of every source file a result may depend on, and of the packages beneath."""
    digest = hashlib.sha256(platform.python_version().encode())
    for path in sorted(PACKAGE.rglob("*.py")):
        place = path.relative_to(PACKAGE)
        if place.parts[0] not in NOT_BEARING:
            digest.update(f"{place.as_posix()}\n".encode())
            digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    for package in PACKAGES:
        try:
            digest.update(f"{package} {version(package)}\n".encode())
        except PackageNotFoundError:
            digest.update(f"{package} none\n".encode())
    return digest.hexdigest()[:16]
