"""A feeder wherever it comes from: a network file, a scenario's tables, pandapower by name."""

from pathlib import Path

from evdash.errors import Fault, InputError
from evdash.files.draft import Draft
from evdash.files.folder import read_files
from evdash.grid.nets.records import Net
from evdash.grid.nets.shipped import SHIPPED
from evdash.imports.feeder import feeder_of_net, shipped_net, with_network, with_tables
from evdash.imports.pandapower_json import MAX_BYTES, read_net
from evdash.imports.workbook import in_sheets, is_workbook, scenario_parts

FORMS = "a pandapower .json, a scenario folder, its .zip, an .xlsx"


def read_bounded(path: Path, most_bytes: int = MAX_BYTES) -> bytes:
    """A file's bytes; InputError where it cannot be read or is too large."""
    try:
        size = path.stat().st_size
        if size > most_bytes:
            rule = f"at most {most_bytes // 2**20} MiB"
            raise InputError([Fault(str(path), f"{size / 2**20:.1f} MiB", rule)])
        return path.read_bytes()
    except OSError as error:
        found = f"something unreadable ({error.strerror or error})"
        raise InputError([Fault(str(path), found, "should be a file")]) from error


def with_feeder_from(
    draft: Draft, what: str, source: str | None, station: str | None
) -> tuple[Draft, tuple[str, ...]]:
    """The draft on the feeder `what` names, and everything there is to say of it."""
    path = Path(what)
    if not path.exists() and what in SHIPPED:
        return _on_network(draft, *shipped_net(what), source, station)
    if path.suffix.lower() == ".json":
        return _on_network(draft, *read_net(path.name, read_bounded(path)), source, station)
    if is_workbook(what):
        return with_tables(draft, scenario_parts(path.name, read_bounded(path)))
    if path.is_dir() or path.suffix.lower() == ".zip":
        return with_tables(draft, read_files(path))
    rule = f"should be {FORMS}, or one of {', '.join(SHIPPED)}"
    raise InputError([Fault(what, "something else" if path.exists() else "nothing there", rule)])


def _on_network(
    draft: Draft, net: Net, unread: tuple[str, ...], source: str | None, station: str | None
) -> tuple[Draft, tuple[str, ...]]:
    imported = feeder_of_net(net, unread, source)
    changed, told = with_network(draft, imported, station)
    return changed, (*imported.notices, *told)


def sheet_faults(what: str, error: InputError) -> InputError:
    """An error in the words of the workbook it concerns, if it came from one."""
    name = Path(what).name
    return InputError(in_sheets(name, error.faults)) if is_workbook(what) else error
