"""Which column of a table means what: proposed by names they go by, confirmed by the user."""

import re
from collections.abc import Mapping, Sequence

from evdash.errors import Fault, InputError


def proposed_by(known: Mapping[str, Sequence[str]], columns: Sequence[str]) -> dict[str, str]:
    """A column for each field whose name is known, the better known name first."""
    plain = {plain_name(column): column for column in reversed(columns)}
    found = {}
    for field, names in known.items():
        match = next((plain[name.lower()] for name in names if name.lower() in plain), None)
        if match is not None:
            found[field] = match
    return found


def plain_name(column: str) -> str:
    """A column's name without case and signs."""
    return re.sub(r"[^a-z0-9]", "", column.lower())


def checked(
    mapping: Mapping[str, str],
    columns: Sequence[str],
    fields: Mapping[str, str],
    required: Sequence[str],
) -> dict[str, str]:
    """The mapping without blanks; InputError names unknown fields and columns, and what lacks."""
    faults = []
    kept = {field: column for field, column in mapping.items() if column}
    for field, column in kept.items():
        if field not in fields:
            faults.append(Fault("mapping", repr(field), f"fields are {', '.join(fields)}"))
        elif column not in columns:
            rule = f"columns of the table are {', '.join(columns)}"
            faults.append(Fault(f"mapping, {field}", repr(column), rule))
    faults += [
        Fault(f"mapping, {field}", "no column", f"should be given: {fields[field]}")
        for field in required
        if field not in kept
    ]
    if faults:
        raise InputError(faults)
    return kept
