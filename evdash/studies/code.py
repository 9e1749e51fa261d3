"""Which code a result comes from: a result of other code is never taken for one of this."""

import hashlib
import importlib.util
import platform
from functools import lru_cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from evdash.policies.registry import RULES, given
from evdash.resources import INSTALLED, PACKAGE

NOT_BEARING = ("api", "ui", "charts", "cli", "store", "explain", "audit", INSTALLED.name)
"""Parts of the program no result of a study comes from."""
PACKAGES = ("numpy", "scipy", "highspy", "pulp", "power-grid-model", "pandapower", "pydantic")


def code_of(policy: str) -> str:
    """The digest of the code that a policy's results depend on: `code_version`, and of a policy
    from outside every source file of its module, or of the whole package that is of."""
    if policy in RULES:
        return code_version()
    return _with_outside(given(policy).name.partition(":")[0].partition(".")[0])


@lru_cache(maxsize=32)
def _with_outside(package: str) -> str:
    found = importlib.util.find_spec(package)
    folders = [] if found is None else found.submodule_search_locations or []
    files = sorted(path for folder in folders for path in Path(folder).rglob("*.py"))
    if not files and found is not None and found.origin is not None:
        files = [Path(found.origin)]
    digest = hashlib.sha256(code_version().encode())
    for path in files:
        digest.update(path.read_bytes().replace(b"\r\n", b"\n"))
    return digest.hexdigest()[:16]


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
