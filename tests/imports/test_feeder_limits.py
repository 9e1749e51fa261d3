"""Limits of a pandapower network: held as pandapower counts them, or told where they are not."""

from typing import Any

import numpy as np
import pandapower as pp
import pandapower.networks
import pytest

from evdash.errors import InputError
from evdash.files.bundled import DEFAULT
from evdash.files.draft import draft_of, scenario_of
from evdash.files.scenario_folder import read_scenario
from evdash.grid.acflow import ac_flow
from evdash.grid.handover import handover_json
from evdash.grid.nets.convert import converted
from evdash.grid.nets.feeder import ConvertedFeeder
from evdash.grid.nets.referee import full_load
from evdash.imports.feeder import feeder_of_net, node_called, supplies_of, with_network
from evdash.imports.pandapower_json import read_net
from tests.imports.networks import TRAFO, line, ring, two_levels


def read(net: Any) -> Any:
    return read_net("net.json", pp.to_json(net).encode())[0]


def of(net: Any, source: str | None = None) -> ConvertedFeeder:
    return converted(read(net), source)


def told(net: Any, source: str | None = None) -> str:
    return "\n".join(of(net, source).notices)


def faults_of(net: Any, source: str | None = None) -> str:
    with pytest.raises(InputError) as error:
        of(net, source)
    return str(error.value)


def short_chain(percent: float | None, df: float, parallel: int, load_mw: float) -> Any:
    """source ─ a ─▷ b (0.4 kV), short and at nominal voltage, with one load at its end."""
    net = pp.create_empty_network()
    source, a = (pp.create_bus(net, vn_kv=20.0, name=name) for name in ("source", "a"))
    b = pp.create_bus(net, vn_kv=0.4, name="b")
    pp.create_ext_grid(net, source)
    limits = {"df": df, "parallel": parallel}
    limits |= {} if percent is None else {"max_loading_percent": percent}
    line(net, source, a, length_km=0.001, c_nf_per_km=0.0, max_i_ka=0.03, **limits)
    small = {"pfe_kw": 0.0, "i0_percent": 0.0, "vk_percent": 0.01, "vkr_percent": 0.001}
    pp.create_transformer_from_parameters(net, a, b, **(TRAFO | small), **limits)
    pp.create_load(net, b, p_mw=load_mw, q_mvar=load_mw / 3)
    return net


@pytest.mark.parametrize("percent", [None, 60.0, 100.0, 130.0])
@pytest.mark.parametrize(("df", "parallel"), [(1.0, 1), (0.8, 1), (1.0, 3), (0.7, 2)])
@pytest.mark.parametrize("load_mw", [0.2, 0.7, 1.5])
def test_what_exceeds_a_limit_in_pandapower_exceeds_it_here(percent, df, parallel, load_mw) -> None:
    net = short_chain(percent, df, parallel, load_mw)
    feeder = of(net)
    flow = ac_flow(full_load(feeder), np.zeros(1))
    pp.runpp(net, numba=False)
    found = zip(feeder.lines, (net.res_line, net.res_trafo), flow.line_kva[0], strict=True)
    for row, result, kva in found:
        loading = result.loading_percent[0] / (percent or 100.0)
        assert row.rating_kva is not None
        assert kva / row.rating_kva == pytest.approx(loading, rel=2e-3)
        assert (kva > row.rating_kva) == (loading > 1)


def test_a_loading_limit_is_told_with_its_size() -> None:
    words = told(short_chain(80.0, 1.0, 1, 0.1))
    assert "max_loading_percent of 80 % is part of the ratings of 2 lines or transformers" in words
    assert "max_loading_percent" not in told(short_chain(None, 1.0, 1, 0.1))
    assert "max_loading_percent" not in told(short_chain(100.0, 1.0, 1, 0.1))


@pytest.mark.parametrize("column", ["max_loading_percent", "df"])
@pytest.mark.parametrize("value", [0.0, -10.0])
@pytest.mark.parametrize("table", ["line", "trafo"])
def test_a_limit_that_lets_nothing_through_is_refused(table, column, value) -> None:
    net = short_chain(90.0, 1.0, 1, 0.1)
    net[table][column] = value
    words = faults_of(net)
    assert f"table {table}, row 0, column {column}" in words
    assert "should be at least 0.0001" in words


@pytest.mark.parametrize(
    ("current", "why"),
    [
        (np.nan, "no max_i_ka"),
        (0.0, "a max_i_ka of 0"),
        (99_999.0, "a max_i_ka from 9,999 kA on"),
    ],
)
def test_a_line_without_a_limit_is_told_by_name(current, why) -> None:
    net = ring(closed=False)
    net.line.loc[1, ["max_i_ka", "name"]] = current, "the middle"
    feeder = of(net)
    assert [row.rating_kva is None for row in feeder.lines].count(True) == 1
    words = "\n".join(feeder.notices)
    assert f"1 of 3 lines have {why}" in words
    assert "line 1 'the middle'" in words
    assert "rating_kva in lines.csv" in words


def test_lines_that_all_have_limits_are_not_told_of() -> None:
    assert "nothing that limits" not in told(ring(closed=False))


def test_no_line_without_a_limit_is_left_untold_in_what_pandapower_ships() -> None:
    for network in (pandapower.networks.case33bw, pandapower.networks.create_cigre_network_mv):
        feeder = of(network())
        missing = sum(row.rating_kva is None for row in feeder.lines)
        assert (missing > 0) == ("nothing that limits" in "\n".join(feeder.notices))


def limited(table: str, column: str, value: float) -> Any:
    net = two_levels()
    if table == "switch":
        pp.create_switch(net, 1, 0, et="l", closed=True)
    net[table][column] = value
    return net


@pytest.mark.parametrize(
    ("table", "column"),
    [
        ("ext_grid", "max_p_mw"),
        ("ext_grid", "min_q_mvar"),
        ("load", "max_p_mw"),
        ("sgen", "max_q_mvar"),
        ("storage", "min_p_mw"),
        ("switch", "in_ka"),
        ("trafo", "max_something_new"),
        ("bus", "rating_kva"),
    ],
)
def test_every_limit_that_is_not_held_is_told_with_its_place_and_value(table, column) -> None:
    words = told(limited(table, column, 0.123))
    (sentence,) = [note for note in words.split("\n") if column in note]
    assert "0.123" in sentence
    assert "is not held" in sentence
    assert f"{table} 0" in sentence
    assert column not in told(two_levels())
    assert column not in told(limited(table, column, np.nan))


@pytest.mark.parametrize("column", ["leakage_resistance_ratio_hv", "leakage_reactance_ratio_hv"])
def test_an_uneven_leakage_is_told(column) -> None:
    net = two_levels()
    net.trafo[column] = 0.8
    assert column in told(net)
    net.trafo[column] = 0.5
    assert column not in told(net)


@pytest.mark.parametrize(
    ("low", "high", "taken", "words"),
    [
        (0.95, 1.05, (0.95, 1.05), "limits of 0.95 to 1.05 pu are the file's"),
        (np.nan, 1.05, (None, 1.05), "upper voltage limit of 1.05 pu is the file's"),
        (0.95, np.nan, (0.95, None), "no upper voltage limit; the scenario keeps its own"),
        (0.0, 1.05, (None, 1.05), "min_vm_pu of 0 pu, is none a scenario can hold"),
        (0.95, 2.0, (0.95, None), "max_vm_pu of 2 pu, is none"),
        (1.05, 0.95, (None, None), "min_vm_pu of 1.05 pu, is none"),
    ],
)
def test_each_side_of_the_voltage_limits_is_taken_or_told(low, high, taken, words) -> None:
    net = ring(closed=False)
    net.bus["min_vm_pu"], net.bus["max_vm_pu"] = low, high
    feeder = of(net)
    assert (feeder.voltage_min_pu, feeder.voltage_max_pu) == taken
    assert words in "\n".join(feeder.notices)


def test_different_voltage_limits_are_told_with_their_span_also_behind_switches() -> None:
    net = ring(closed=False)
    net.bus["min_vm_pu"] = 0.95
    extra = pp.create_bus(net, vn_kv=20.0, name="extra", min_vm_pu=0.97)
    pp.create_switch(net, 2, extra, et="b", closed=True)
    feeder = of(net)
    assert feeder.voltage_min_pu is None
    assert "4 of 4 buses have a lower voltage limit, min_vm_pu of 0.95 to 0.97 pu" in "\n".join(
        feeder.notices
    )


def twins(*names: str | None) -> Any:
    """Separate feeders, each with a supply of the given name and everything worth telling."""
    net = pp.create_empty_network()
    for name in names:
        top = pp.create_bus(net, vn_kv=20.0, name=name)
        middle = pp.create_bus(net, vn_kv=20.0, name=f"m{top}")
        low = pp.create_bus(net, vn_kv=0.4, name=f"l{top}")
        far = pp.create_bus(net, vn_kv=0.4, name=f"f{top}")
        pp.create_ext_grid(net, top, max_p_mw=5.0)
        line(net, top, middle, max_i_ka=np.nan)
        stub = line(net, middle, top, name=f"stub {top}")
        pp.create_switch(net, middle, stub, et="l", closed=False)
        pp.create_transformer_from_parameters(net, middle, low, **TRAFO)
        line(net, low, far, length_km=0.1)
        out = line(net, low, far)
        net.line.loc[out, "in_service"] = False
        pp.create_load(net, far, p_mw=0.1, q_mvar=0.0, scaling=0.5, const_z_p_percent=20.0)
        pp.create_storage(net, far, p_mw=0.01, max_e_mwh=0.1)
    return net


def test_what_is_counted_is_of_the_feeder_taken_and_no_other() -> None:
    alone = list(of(twins("one")).notices)
    beside = list(of(twins("one", "two", "three"), "one").notices)
    assert any("1 transformers turn the phase" in note for note in alone)
    assert alone[0].replace("4 of 4", "4 of 12") == beside[0]
    left_out = [note for note in beside if "not supplied from this source" in note]
    assert len(left_out) == 1
    assert [note for note in beside[1:] if note not in left_out] == alone[1:]


@pytest.mark.parametrize("wanted", ["4", "bus 4", " bus 4 "])
def test_every_name_a_refusal_gives_is_taken(wanted) -> None:
    net = twins("one", None)
    listed = faults_of(net, "nowhere")
    assert "one, bus 4" in listed
    assert of(net, wanted).source_node == "bus 4"
    assert set(supplies_of(read(net)).values()) == {"one", "bus 4"}


def test_supplies_of_the_same_name_are_told_apart() -> None:
    net = twins("same", "same")
    words = faults_of(net, "same")
    assert "'same', which 2 buses are called" in words
    assert "same (0), same (4)" in words
    assert "same (0), same (4)" in faults_of(net)
    for wanted in ("same (4)", "4", "bus 4"):
        assert "m4" in {node.node for node in of(net, wanted).nodes}
    assert supplies_of(read(net)) == {"0": "same (0)", "4": "same (4)"}


def test_a_station_is_found_by_what_its_bus_is_called() -> None:
    net = twins("one", "two")
    joined = pp.create_bus(net, vn_kv=0.4, name="depot")
    pp.create_switch(net, 3, joined, et="b", closed=True)
    checked, feeder = read(net), of(net, "one")
    for wanted in ("f0", "3", " bus 3", "depot", str(joined)):
        assert node_called(checked, feeder, wanted) == "f0"
    for wanted, words in (("nowhere", "m0, l0, f0"), ("m4", "not supplied from one")):
        with pytest.raises(InputError, match=words):
            node_called(checked, feeder, wanted)


def test_a_rating_beyond_what_a_scenario_takes_is_refused_in_words() -> None:
    net = short_chain(1e9, 1.0, 1000, 0.1)
    with pytest.raises(InputError, match="rating_kva"):
        feeder_of_net(read(net))


def test_a_network_handed_on_keeps_its_limits_when_it_comes_back() -> None:
    net = short_chain(80.0, 0.9, 2, 0.1)
    net.bus["min_vm_pu"], net.bus["max_vm_pu"] = 0.94, 1.06
    draft, _ = with_network(draft_of(read_scenario(DEFAULT)), feeder_of_net(read(net)))
    scenario = scenario_of(draft)
    text = handover_json(scenario, np.zeros(scenario.intervals), 0)
    back = converted(read_net("back.json", text.encode())[0])
    assert (back.voltage_min_pu, back.voltage_max_pu) == (0.94, 1.06)
    want = [row.rating_kva for row in scenario.lines]
    assert [row.rating_kva for row in back.lines] == pytest.approx(want)
