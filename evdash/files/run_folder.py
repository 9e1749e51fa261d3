"""A run's folder: written as a whole or not at all, and read back for the audit."""

import hashlib
from collections.abc import Mapping
from pathlib import Path

from evdash.errors import Fault, InputError
from evdash.files.exchange import Claim
from evdash.files.nested import read_json
from evdash.files.scenario_folder import FILE_NAMES

SUMMARY = "summary.json"
SCENARIO = "scenario"
RUN_FORMAT = "evdash run 1"
TABLES = ("intervals.csv", "vehicles.csv", "ledger.csv", "power.csv", "voltages.csv")
EXPLAINED = ("explanations.csv", "worths.csv", "binding.csv", "revisions.csv")
RUN_FILES = (SUMMARY, *TABLES, *EXPLAINED, *(f"{SCENARIO}/{name}" for name in FILE_NAMES))
"""Every file that a run may have; others in its folder are somebody's own."""


def scenario_hash(files: Mapping[str, bytes]) -> str:
    """SHA-256 over the names and contents of a resolved scenario's files, README.md apart."""
    digest = hashlib.sha256()
    for name in sorted(set(files) - {"README.md"}):
        digest.update(f"{name}\n{len(files[name])}\n".encode())
        digest.update(files[name])
    return digest.hexdigest()


def is_run(directory: Path) -> bool:
    """Whether a folder holds a run."""
    try:
        summary = read_json((directory / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(summary, dict) and summary.get("format") == RUN_FORMAT


def write_run(claim: Claim, files: Mapping[str, str]) -> None:
    """Put a run's files, paths relative to its folder, in place of an earlier run's.

    Only files that a run has are replaced; what else lies in the folder stays as it is.
    """
    claim.replace(files, own=RUN_FILES, last=SUMMARY)


def read_run(directory: Path) -> tuple[dict[str, bytes], dict[str, object]]:
    """A run folder's tables and its summary; raises InputError if it is not one."""
    allowed = "should be a folder written by `evdash run --out`"
    if not directory.is_dir():
        raise InputError([Fault(str(directory), "no such folder", allowed)])
    try:
        summary = read_json((directory / SUMMARY).read_text(encoding="utf-8"))
        files = {p.name: p.read_bytes() for p in directory.iterdir() if p.suffix == ".csv"}
    except (OSError, ValueError) as error:
        found = f"a {SUMMARY} that cannot be read ({error})"
        raise InputError([Fault(str(directory), found, allowed)]) from error
    if not isinstance(summary, dict) or summary.get("format") != RUN_FORMAT:
        raise InputError([Fault(f"{directory}/{SUMMARY}", "another format", allowed)])
    return files, summary
