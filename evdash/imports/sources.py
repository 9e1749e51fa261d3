"""Feeders and workbooks by what a user names: a file, a folder, a network by pandapower."""

from dataclasses import dataclass
from pathlib import Path

from evdash.errors import Fault, InputError
from evdash.files.draft import Draft
from evdash.files.folder import read_files
from evdash.grid.nets.records import Net
from evdash.grid.nets.shipped import SHIPPED
from evdash.imports.feeder import feeder_of_net, node_called, shipped_net, with_network, with_tables
from evdash.imports.pandapower_json import MAX_BYTES, read_net
from evdash.imports.scenario_book import ScenarioBook, read_book, with_book
from evdash.imports.workbook import is_workbook

RULE = "should be a workbook (.xlsx) with a scenario's sheets"
FORMS = "a pandapower .json, a scenario folder, its .zip, an .xlsx"


@dataclass(frozen=True, slots=True)
class Imported:
    """A draft with something taken in, what there is to say of it, and the workbook it is from."""

    draft: Draft
    told: tuple[str, ...]
    book: ScenarioBook | None = None

    def placed(self, error: InputError) -> InputError:
        """An error in the words of the workbook the draft is from, if it is from one."""
        return InputError(self.book.placed(error.faults)) if self.book else error


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


def with_workbook_from(draft: Draft, path: Path) -> Imported:
    """The draft with every sheet of a scenario that a workbook has."""
    if not is_workbook(path.name):
        raise InputError([Fault(str(path), "a file of another kind", RULE)])
    book = read_book(path.name, read_bounded(path))
    return Imported(*with_book(draft, book), book)


def with_feeder_from(draft: Draft, what: str, source: str | None, station: str | None) -> Imported:
    """The draft on the feeder `what` names, and everything there is to say of it."""
    path = Path(what)
    if not path.exists() and what in SHIPPED:
        return _on_network(draft, *shipped_net(what), source, station)
    if path.suffix.lower() == ".json":
        return _on_network(draft, *read_net(path.name, read_bounded(path)), source, station)
    if is_workbook(what):
        book = read_book(path.name, read_bounded(path)).of_feeder()
        try:
            return Imported(*with_tables(draft, book.files), book)
        except InputError as error:
            raise InputError(book.placed(error.faults)) from None
    if path.is_dir() or path.suffix.lower() == ".zip":
        return Imported(*with_tables(draft, read_files(path)))
    rule = f"should be {FORMS}, or one of {', '.join(SHIPPED)}"
    raise InputError([Fault(what, "something else" if path.exists() else "nothing there", rule)])


def _on_network(
    draft: Draft, net: Net, unread: tuple[str, ...], source: str | None, station: str | None
) -> Imported:
    imported = feeder_of_net(net, unread, source)
    node = None if station is None else node_called(net, imported.feeder, station)
    changed, told = with_network(draft, imported, node)
    return Imported(changed, (*imported.notices, *told))
