"""The network handed on, read by pandapower alone: it gives the voltages that were told."""

import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings

from evdash.domain.scenario import Scenario
from evdash.grid.acflow import ac_flow
from evdash.grid.handover import STATION, handover_json
from tests.builders import line, make_scenario, node, scenarios

ALONE = """
import json, sys
import pandapower
from pandapower.timeseries import run_timeseries
net = pandapower.from_json(sys.argv[1])
pandapower.runpp(net, numba=False)
one = net.res_bus.vm_pu.tolist()
loading = net.res_line.loading_percent.tolist()
run_timeseries(net, time_steps=range(int(sys.argv[2])), verbose=False, numba=False)
values = net.output_writer.iloc[0].object.output["res_bus.vm_pu"]
print(json.dumps({
    "names": net.bus.name.tolist(), "one": one, "loading": loading,
    "day": values.to_numpy().tolist(), "lines": net.line.name.tolist(),
    "station": float(net.load.p_mw[net.load.name == sys.argv[3]].sum()),
    "geo": net.bus.geo.tolist() if "geo" in net.bus else [],
}))
"""
FEEDER = {
    "nodes": [
        node("s", x=0.0, y=0.0),
        node("a", load_kw=60, shunt_kvar=30, x=1.0, y=0.0),
        node("b<i>", load_kw=40, load_kvar=-5, generation_kw=90, x=2.0, y=1.0),
    ],
    "lines": [line("s", "a", rating=150.0), line("b<i>", "a", x=0.0)],
}
DAY = {"price": (0.1, 0.2, 0.3), "load": (0.4, 1.0, 0.7), "generation": (0.0, 0.5, 1.0)}


def read_alone(path: Path, intervals: int) -> dict:
    """What pandapower makes of a file in a process of its own, without any code of ours."""
    arguments = [str(path), str(intervals), STATION]
    told = subprocess.run(
        [sys.executable, "-c", ALONE, *arguments],
        capture_output=True,
        check=False,
        encoding="utf-8",
        cwd=path.parent,
    )
    assert told.returncode == 0, told.stderr
    return json.loads(told.stdout.splitlines()[-1])


def test_pandapower_alone_finds_the_same_voltages_for_one_interval_and_for_the_day(tmp_path):
    scenario = make_scenario(**FEEDER, **DAY)
    station_kw = np.array([5.0, 30.0, 12.5])
    path = tmp_path / "net.json"
    path.write_text(handover_json(scenario, station_kw, 1), encoding="utf-8")
    found = read_alone(path, 3)
    told = ac_flow(scenario, station_kw)
    assert found["names"] == ["s", "a", "b<i>"]
    assert found["one"][1:] == pytest.approx(told.voltage_pu[1], abs=1e-8)
    assert np.array(found["day"])[:, 1:] == pytest.approx(told.voltage_pu, abs=1e-8)
    # after the day the loads are its last interval's
    assert found["station"] == pytest.approx(0.0125)
    assert [json.loads(place)["coordinates"] for place in found["geo"]] == [[0, 0], [1, 0], [2, 1]]


def test_loading_is_what_the_rating_allows_at_nominal_voltage(tmp_path):
    scenario = make_scenario(**FEEDER, **DAY)
    path = tmp_path / "net.json"
    path.write_text(handover_json(scenario, np.zeros(3), 1), encoding="utf-8")
    found = read_alone(path, 3)
    kva = ac_flow(scenario, np.zeros(3)).line_kva[1]
    # the current's share, near the power's where voltages are near 1 pu
    assert found["loading"][0] == pytest.approx(100 * kva[0] / 150, rel=0.03)
    assert np.isnan(found["loading"][1])


def test_every_limit_of_the_scenario_is_in_the_network():
    import pandapower

    nodes = [node("s"), node("a", load_kw=60, rating_kva=70.0), node("b<i>", load_kw=40)]
    band = {"voltage_min_pu": 0.94, "voltage_max_pu": 1.05}
    scenario = make_scenario(**{**FEEDER, "nodes": nodes}, feeder=band, **DAY)
    net = pandapower.from_json_string(handover_json(scenario, np.zeros(3), 1))
    assert net.bus.min_vm_pu.tolist()[1:] == [0.94, 0.94]
    assert net.bus.max_vm_pu.tolist()[1:] == [1.05, 1.05]
    assert net.bus[["min_vm_pu", "max_vm_pu"]].iloc[0].isna().all()  # the source holds its own
    assert net.bus.rating_kva.tolist()[1] == 70.0
    assert net.bus.rating_kva.isna().tolist() == [True, False, True]
    assert net.line.max_i_ka[0] * np.sqrt(3) * 4.16 * 1000 == pytest.approx(150.0)
    assert net.line.max_loading_percent[0] == 100.0


@settings(max_examples=8)
@given(scenarios(max_nodes=6, max_vehicles=0))
def test_any_feeder_is_handed_on_with_its_voltages(scenario: Scenario):
    import pandapower

    station_kw = np.linspace(0.0, 20.0, scenario.intervals)
    told = ac_flow(scenario, station_kw)
    t = scenario.intervals // 2
    net = pandapower.from_json_string(handover_json(scenario, station_kw, t))
    pandapower.runpp(net, numba=False)
    assert net.res_bus.vm_pu.to_numpy()[1:] == pytest.approx(told.voltage_pu[t], abs=1e-7)
