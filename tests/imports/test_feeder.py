"""Networks by pandapower as feeders, held against pandapower's own power flow of them."""

import json
from typing import Any

import numpy as np
import pandapower as pp
import pandapower.networks
import pytest

from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import draft_of, scenario_of
from evdash.files.scenario_folder import read_scenario
from evdash.grid.acbatch import AcBatch
from evdash.grid.lindistflow import base_injections
from evdash.grid.nets.convert import converted
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.referee import full_load
from evdash.grid.nets.shipped import SHIPPED, shipped_json
from evdash.grid.radial import radial_feeder
from evdash.imports.feeder import feeder_of_net, with_network
from evdash.imports.pandapower_json import read_net
from tests.imports.networks import line, ring, two_levels

SEVERAL_SOURCES = {"mv_oberrhein": "58"}
# Beyond what constant powers in place of line charging and iron losses account for.
CLOSE_PU = {"cigre_mv": 1e-3, "cigre_mv_pv_wind": 1e-3, "mv_oberrhein": 5e-4, "mv_open_ring": 5e-5}


def of(net: Any, source: str | None = None) -> ConvertedFeeder:
    return converted(read_net("net.json", pp.to_json(net).encode())[0], source)


def faults_of(net: Any) -> str:
    with pytest.raises(InputError) as error:
        of(net)
    return str(error.value)


def voltages(feeder: ConvertedFeeder) -> dict[str, float]:
    """Voltages by power-grid-model, per unit of each bus's own nominal voltage."""
    scenario = full_load(feeder)
    radial = radial_feeder(scenario)
    powers = base_injections(scenario, radial)
    flows = AcBatch(scenario, radial).solve(powers.active_kw, powers.reactive_kvar)
    found = dict(zip(radial.nodes, flows.voltage_pu[0], strict=True))
    return {node: float(v) * feeder.scale_of_node[node] for node, v in found.items()}


def worst_pu(net: Any, feeder: ConvertedFeeder) -> float:
    """Against pandapower's power flow of the network itself, never of what we made of it."""
    pp.runpp(net, numba=False, tolerance_mva=1e-9)
    ours = voltages(feeder)
    pairs = [
        (ours[n], net.res_bus.vm_pu.at[bus]) for bus, n in feeder.node_of_bus.items() if n in ours
    ]
    assert len(pairs) >= len(ours)
    return max(abs(a - b) for a, b in pairs)


@pytest.mark.parametrize("name", sorted(SHIPPED))
def test_networks_pandapower_ships_keep_their_voltages(name: str) -> None:
    text = shipped_json(name)
    feeder = converted(read_net(name, text)[0], SEVERAL_SOURCES.get(name))
    original = pp.from_json_string(text.decode())
    assert worst_pu(original, feeder) < CLOSE_PU.get(name, 1e-5)


@pytest.mark.parametrize("tap_pos", [-3, -1, 0, 2])
@pytest.mark.parametrize("degree", [0.0, 60.0])
def test_taps_losses_shunts_and_two_levels_keep_their_voltages(tap_pos, degree) -> None:
    net = two_levels(tap_pos, degree)
    feeder = of(net)
    assert worst_pu(net, feeder) < 2e-4
    behind = feeder.scale_of_node["c"]
    assert feeder.scale_of_node["a"] == pytest.approx(1.0)
    if degree == 0:
        assert behind == pytest.approx(1 / (1 + 0.025 * tap_pos))
        assert any("×" in told for told in feeder.notices) == (tap_pos != 0)


def test_a_wrong_tap_would_be_seen() -> None:
    net = two_levels(-2)
    feeder = of(two_levels(-1))
    assert worst_pu(net, feeder) > 1e-2


def test_what_is_converted_is_told_with_its_size() -> None:
    told = " ".join(of(two_levels()).notices)
    for words in (
        "Line charging",
        "no-load losses",
        "Shunts and wards",
        "turn the phase",
        "storages are taken at the -10.0 kW",
        "generators of 40.0 kW",
        "scaling of 1",
        "Voltage levels of 20, 0.4 kV",
    ):
        assert words in told


def test_the_difference_told_is_the_difference() -> None:
    net = two_levels()
    imported = feeder_of_net(read_net("x", pp.to_json(net).encode())[0])
    assert imported.difference is not None
    assert imported.difference.worst_pu == pytest.approx(worst_pu(net, imported.feeder), abs=1e-7)
    supply = float(net.res_ext_grid.p_mw.sum()) * 1000
    assert imported.difference.original_supply_kw == pytest.approx(supply, rel=1e-6)
    assert abs(imported.difference.supply_kw) < 1.0  # impedances at 1.02 pu, as at 1


def test_a_ring_runs_as_operated_and_a_closed_one_is_named() -> None:
    net = ring(closed=False)
    assert worst_pu(net, of(net)) < 1e-5
    assert "open at one end" in " ".join(of(net).notices)
    told = faults_of(ring(closed=True))
    assert "loop" in told
    assert all(name in told for name in ("source", "a", "b", "c"))
    meshed = ring(closed=True)
    meshed.line.loc[meshed.line.name == "back", "in_service"] = False
    assert len(of(meshed).lines) == 3


def test_parallel_lines_of_different_kinds_become_one() -> None:
    net = pp.create_empty_network()
    a, b = (pp.create_bus(net, vn_kv=10.0, name=name) for name in "ab")
    pp.create_ext_grid(net, a)
    line(net, a, b, c_nf_per_km=0)
    line(net, b, a, r_ohm_per_km=0.1, max_i_ka=0.3, c_nf_per_km=0)
    pp.create_load(net, b, p_mw=2.0, q_mvar=0.5)
    feeder = of(net)
    assert worst_pu(net, feeder) < 1e-8
    pp.runpp(net, numba=False)
    rating = feeder.lines[0].rating_kva
    through = np.hypot(net.res_line.p_from_mw[0] - net.res_line.p_to_mw[1], 0)
    assert rating is not None
    # the line that is loaded most is as loaded as the one row says
    assert net.res_line.loading_percent.max() == pytest.approx(
        100 * 1000 * np.hypot(net.res_ext_grid.p_mw[0], net.res_ext_grid.q_mvar[0]) / rating,
        rel=1e-3,
    )
    assert through > 0


def test_switches_between_buses_join_or_part_them() -> None:
    net = ring(closed=False)
    extra = pp.create_bus(net, vn_kv=20.0, name="extra")
    pp.create_load(net, extra, p_mw=0.1)
    pp.create_switch(net, 2, extra, et="b", closed=True)
    feeder = of(net)
    assert feeder.node_of_bus[extra] == feeder.node_of_bus[2]
    assert worst_pu(net, feeder) < 1e-5
    net.switch.loc[net.switch.et == "b", "closed"] = False
    assert "left out with 1 loads of 100.0 kW" in " ".join(of(net).notices)


def test_several_supplies_are_to_be_chosen_from() -> None:
    net = pandapower.networks.mv_oberrhein()
    told = faults_of(net)
    assert "one source" in told
    assert "bus" in told.lower()
    with pytest.raises(InputError, match="'nowhere'"):
        of(net, "nowhere")


@pytest.mark.parametrize(
    ("network", "words"),
    [
        (pandapower.networks.case9, "gen 0"),
        (pandapower.networks.example_multivoltage, "trafo3w 0"),
        (pandapower.networks.ieee_european_lv_asymmetric, "asymmetric_load"),
        (pandapower.networks.case6ww, "gen"),
    ],
)
def test_what_cannot_be_carried_is_refused_by_name(network, words) -> None:
    assert words in faults_of(network())


def test_loads_that_depend_on_voltage_are_told() -> None:
    net = ring(closed=False)
    net.load["const_z_p_percent"] = 50.0
    assert "3 loads that depend on voltage" in " ".join(of(net).notices)


def test_names_become_what_a_scenario_allows() -> None:
    net = ring(closed=False)
    net.bus["name"] = ["=cmd()", "same", "same", "x" * 99]
    feeder = of(net)
    assert set(feeder.node_of_bus.values()) == {"bus 0", "same (1)", "same (2)", "bus 3"}


@pytest.mark.parametrize("name", ["case33bw", "cigre_mv", "four_bus"])
def test_a_day_can_begin_on_an_imported_feeder(name: str) -> None:
    base = draft_of(read_scenario(DEFAULT))
    draft, told = with_network(base, feeder_of_net(read_net(name, shipped_json(name))[0]))
    scenario = scenario_of(draft)
    assert scenario.station.node in {node.node for node in scenario.nodes}
    assert scenario.feeder.source_node != scenario.station.node
    assert any("station is put at" in words for words in told)
    assert (name == "four_bus") == any("no generation" in words for words in told)


def edited(change: Any) -> bytes:
    data = json.loads(pp.to_json(ring(closed=False)))
    change(data["_object"])
    return json.dumps(data).encode()


def frame(content: dict[str, Any], table: str) -> dict[str, Any]:
    return json.loads(content[table]["_object"])  # type: ignore[no-any-return]


def put(table: str, column: str, row: int, value: object) -> bytes:
    def change(content: dict[str, Any]) -> None:
        data = frame(content, table)
        data["data"][row][data["columns"].index(column)] = value
        content[table]["_object"] = json.dumps(data)

    return edited(change)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (put("bus", "vn_kv", 1, "high"), "table bus, row 1, column vn_kv: found 'high'"),
        (put("bus", "vn_kv", 1, -20.0), "should be at least 0.01"),
        (put("line", "length_km", 2, {"_module": "os", "_class": "system"}), "column length_km"),
        (put("line", "to_bus", 2, 77), "table line, row 2, column to_bus: found 77"),
        (put("ext_grid", "in_service", 0, False), "should have an external grid in service"),
        (edited(lambda c: c.pop("bus")), "table bus"),
        (edited(lambda c: c.update(bus={"_module": "os", "_class": "system"})), "table bus"),
        (edited(lambda c: c.update(f_hz="fast")), "f_hz"),
        (b"{", "text that is not JSON"),
        (b"\xff\xfe", "text that is not JSON"),
        (b"[" * 100_000, "text that is not JSON"),
        (b"[1, 2]", "no network"),
        (b'{"a": NaN}', "no network"),
    ],
)
def test_hostile_and_faulty_files_are_refused_in_words(content: bytes, words: str) -> None:
    with pytest.raises(InputError) as error:
        converted(read_net("net.json", content)[0])
    assert words in str(error.value)


def test_modules_a_file_names_are_never_imported(monkeypatch: pytest.MonkeyPatch) -> None:
    def bomb(content: dict[str, Any]) -> None:
        content["evil"] = {"_module": "antigravity", "_class": "Anything", "_object": "{}"}
        content["controller"] = {
            "_module": "pandas.core.frame",
            "_class": "DataFrame",
            "orient": "split",
            "_object": json.dumps(
                {"columns": ["object"], "index": [0], "data": [[{"_module": "antigravity"}]]}
            ),
        }

    import importlib

    def refuse(name: str, *_: object) -> Any:
        raise AssertionError(name)

    monkeypatch.setattr(importlib, "import_module", refuse)
    net, told = read_net("net.json", edited(bomb))
    assert len(net.bus) == 4
    assert "controller (1 rows)" in " ".join(told)


def test_too_many_rows_are_refused() -> None:
    def grow(content: dict[str, Any]) -> None:
        data = frame(content, "load")
        data["data"] = data["data"][:1] * 20_001
        data["index"] = list(range(20_001))
        content["load"]["_object"] = json.dumps(data)

    with pytest.raises(InputError, match="20,001 rows"):
        read_net("net.json", edited(grow))
