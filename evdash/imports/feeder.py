"""A feeder into a scenario: nodes, lines and what `[feeder]` says, the rest of the day kept."""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from pydantic import ValidationError

from evdash.domain.scenario import Feeder, Line, Node
from evdash.errors import Fault, InputError
from evdash.files.draft import Draft, Row, Rows, read_rows, read_settings
from evdash.files.scenario_folder import SETTINGS
from evdash.files.wording import allowed, found
from evdash.grid.nets.convert import converted
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.records import Net
from evdash.grid.nets.referee import AcDifference, ac_difference
from evdash.grid.nets.shipped import SHIPPED, shipped_json
from evdash.grid.nets.tree import buses_called, names_of
from evdash.imports.pandapower_json import read_net

log = logging.getLogger(__name__)
FULL = "1.0"
SHOWN = 20


@dataclass(frozen=True, slots=True)
class ImportedFeeder:
    """A converted network, what of the file was not read, and how it differs from the original."""

    feeder: ConvertedFeeder
    notices: tuple[str, ...]
    difference: AcDifference | None


def feeder_of_net(
    net: Net, unread: tuple[str, ...] = (), source: str | None = None
) -> ImportedFeeder:
    """A network converted and held against its own AC power flow; InputError where it cannot be."""
    try:
        feeder = converted(net, source)
        difference = ac_difference(net, feeder)
    except ValidationError as error:
        details = error.errors(include_url=False)
        raise InputError(
            [Fault(f"network, {one['loc'][-1]}", found(one), allowed(one)) for one in details]
        ) from None
    except (ArithmeticError, LookupError, TypeError, ValueError) as error:
        log.exception("a network could not be converted")
        told = f"numbers that pandapower makes nothing of ({error})"
        raise InputError([Fault("network", told, "should have an AC power flow")]) from error
    told = (
        difference.text
        if difference is not None
        else "AC power flow at full load has no solution, in the original network or converted."
    )
    return ImportedFeeder(feeder, (*feeder.notices, *unread, told), difference)


def shipped_net(name: str) -> tuple[Net, tuple[str, ...]]:
    """A network that comes with pandapower, read as a user's file would be."""
    if name not in SHIPPED:
        raise InputError([Fault("network", repr(name), f"should be one of {', '.join(SHIPPED)}")])
    return read_net(name, shipped_json(name))


def supplies_of(net: Net) -> dict[str, str]:
    """The buses a network can be supplied from: index as text, as `source` takes it, to label."""
    buses = {bus.index: bus for bus in net.bus if bus.in_service}
    grids = [grid.bus for grid in net.ext_grid if grid.in_service and grid.bus in buses]
    names = names_of([buses[bus] for bus in dict.fromkeys(grids)])
    return {str(bus): name for bus, name in names.items()}


def node_called(net: Net, feeder: ConvertedFeeder, wanted: str) -> str:
    """The node that a person calls by its name here, or by a bus's index or name in the file.

    Raises InputError where it may be several, or none of this feeder.
    """
    if any(node.node == wanted for node in feeder.nodes):
        return wanted
    found = buses_called(wanted, net.bus, feeder.node_of_bus)
    nodes = {feeder.node_of_bus[bus.index] for bus in found if bus.index in feeder.node_of_bus}
    if len(nodes) == 1:
        return nodes.pop()
    if nodes:
        told, rule = f"{len(nodes)} nodes called {wanted!r}", f"one of {', '.join(sorted(nodes))}"
    elif found:
        told = f"{wanted!r}, a bus not supplied from {feeder.source_node}"
        rule = "should be a node of this feeder"
    else:
        names = [node.node for node in feeder.nodes if node.node != feeder.source_node]
        told, rule = repr(wanted), f"should be a node of the feeder: {_some(names)}"
    raise InputError([Fault("station", told, rule)])


def _some(names: Sequence[str]) -> str:
    more = len(names) - SHOWN
    return ", ".join(names[:SHOWN]) + (f" and {more} more" if more > 0 else "")


def station_in(draft: Draft, feeder: ConvertedFeeder) -> str:
    """The node the station has now, where the feeder has one of that name; else the one with the
    largest load."""
    there = _table(draft.settings, "station").get("node")
    names = {node.node for node in feeder.nodes} - {feeder.source_node}
    return there if isinstance(there, str) and there in names else feeder.heaviest_node()


def with_network(
    draft: Draft, imported: ImportedFeeder, station: str | None = None
) -> tuple[Draft, tuple[str, ...]]:
    """The draft on another feeder, and what was set along with it.

    The station stays at its node where the new feeder has one of that name, and otherwise moves
    to the node with the largest load.
    """
    feeder = imported.feeder
    settings = dict(draft.settings)
    settings["feeder"] = _table(settings, "feeder") | _feeder_settings(feeder)
    told = ["Loads are the file's at peak: load_scale is 1."]
    there = _table(settings, "station")
    if station is None:
        station = station_in(draft, feeder)
        if station != there.get("node"):
            told.append(f"The station is put at {station}, the node with the largest load.")
    settings["station"] = there | {"node": station}
    changed = draft.with_settings(settings)
    changed = changed.with_table("nodes.csv", tuple(_row(node, Node) for node in feeder.nodes))
    changed = changed.with_table("lines.csv", tuple(_row(line, Line) for line in feeder.lines))
    return _with_generation(changed, feeder, told), tuple(told)


def _feeder_settings(feeder: ConvertedFeeder) -> dict[str, object]:
    limits = {
        "voltage_min_pu": feeder.voltage_min_pu,
        "voltage_max_pu": feeder.voltage_max_pu,
    }
    return {
        "source_node": feeder.source_node,
        "source_voltage_pu": feeder.source_voltage_pu,
        "base_mva": feeder.base_mva,
        "base_kv": feeder.base_kv,
        "load_scale": 1.0,
    } | {key: value for key, value in limits.items() if value is not None}


def _with_generation(draft: Draft, feeder: ConvertedFeeder, told: list[str]) -> Draft:
    """The draft with a generation profile, if the feeder needs one and there is none."""
    profile = draft.tables.get("profile.csv", ())
    if not feeder.has_generation or all(row["generation_pu"] for row in profile):
        return draft
    told.append("The profile had no generation: it runs at its peak in every such interval.")
    filled = tuple(row | {"generation_pu": row["generation_pu"] or FULL} for row in profile)
    return draft.with_table("profile.csv", filled)


def with_tables(draft: Draft, files: Mapping[str, bytes]) -> tuple[Draft, tuple[str, ...]]:
    """The draft on the feeder of another scenario's files: nodes.csv, lines.csv and, where they
    have a scenario.toml, its `[feeder]` and the station's node."""
    missing = [name for name in ("nodes.csv", "lines.csv") if name not in files]
    if missing:
        raise InputError([Fault(name, "no such file", "should be there") for name in missing])
    faults: list[Fault] = []
    tables: dict[str, Rows] = {}
    for name in ("nodes.csv", "lines.csv"):
        tables[name], found = read_rows(name, files[name])
        faults += found
    told = []
    settings = dict(draft.settings)
    if SETTINGS in files:
        theirs, found = read_settings(files[SETTINGS])
        faults += found
        own = theirs.get("feeder")
        if isinstance(own, dict):
            settings["feeder"] = own
        station = theirs.get("station")
        if isinstance(station, dict) and "node" in station:
            settings["station"] = _table(settings, "station") | {"node": station["node"]}
        told.append("nodes, lines, [feeder] and the station's node are the other scenario's.")
    else:
        known = ", ".join(Feeder.model_fields)
        told.append(f"nodes and lines are the file's; [feeder] is as it was: {known}.")
    if faults:
        raise InputError(faults)
    changed = draft.with_settings(settings)
    for name, rows in tables.items():
        changed = changed.with_table(name, rows)
    return changed, tuple(told)


def _table(settings: Mapping[str, object], key: str) -> dict[str, object]:
    inner = settings.get(key)
    return dict(inner) if isinstance(inner, dict) else {}


def _row(record: Node | Line, kind: type[Node] | type[Line]) -> Row:
    cells = {column: getattr(record, column) for column in kind.model_fields}
    return {
        key: "" if cell is None else cell if isinstance(cell, str) else repr(cell)
        for key, cell in cells.items()
    }
