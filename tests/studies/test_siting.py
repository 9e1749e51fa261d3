"""The best site by node, on 13 and 33 buses, held against pandapower; and its map."""

import numpy as np
import pytest

from evdash.charts.study_map import site_alt, site_map
from evdash.domain.scenario import Scenario
from evdash.files.bundled import DEFAULT
from evdash.files.overrides import edit_scenario
from evdash.files.scenario_folder import read_scenario
from evdash.grid.acflow import ac_flow
from evdash.studies.keys import with_settings
from evdash.studies.reading import read_study
from tests.studies.feeders import case33
from tests.studies.small import finished, rows, write_study

STUDY = """
format = 1
name = "siting"
base = "base"
networks = ["ac", "lindistflow"]
metrics = ["least_headroom_kw", "tightest", "profit", "admitted"]
referee_every = 0

[[axis]]
name = "site"
key = "station.node"
values = "all"
"""


def thirteen() -> Scenario:
    return edit_scenario(read_scenario(DEFAULT), {"arrivals.vehicles_per_day": 6.0})


@pytest.fixture(scope="module", params=[thirteen, case33], ids=["13", "33"])
def sited(request, tmp_path_factory):
    place = tmp_path_factory.mktemp("siting")
    base = request.param()
    file = write_study(place, STUDY, base)
    return read_study(file), rows(finished(file, place / "out"), "runs.csv")


def kept(scenario: Scenario, station_kw: float) -> bool:
    """Whether pandapower finds no limit worsened with the station at one power all day."""
    intervals = scenario.intervals
    flow = ac_flow(scenario, np.full(intervals, station_kw))
    base = ac_flow(scenario, np.zeros(intervals))
    if flow.diverged:
        return False
    low = np.minimum(scenario.feeder.voltage_min_pu, base.voltage_pu)
    rating = np.array([line.rating_kva or np.inf for line in scenario.lines])
    return bool(
        (flow.voltage_pu >= low - 1e-7).all()
        and (flow.line_kva <= np.maximum(rating, base.line_kva) + 1e-3).all()
    )


def test_every_node_but_the_source_is_tried_in_both_models(sited) -> None:
    runs, table = sited
    nodes = {node.node for node in runs.base.nodes} - {runs.base.feeder.source_node}
    assert len(nodes) == len(runs.base.nodes) - 1
    for network in ("ac", "lindistflow"):
        assert {row["site"] for row in table if row["network"] == network} == nodes
    assert {row["status"] for row in table} == {"done"}


def test_pandapower_agrees_on_what_each_site_has_room_for(sited) -> None:
    runs, table = sited
    ac = [row for row in table if row["network"] == "ac"]
    for row in ac[:: max(1, len(ac) // 6)]:
        site = with_settings(runs.base, {"station.node": row["site"]})
        room_kw = float(row["least_headroom_kw"])
        assert kept(site, room_kw), row
        assert not kept(site, 1.01 * room_kw + 1.0), row


def test_losses_never_leave_more_room_than_the_lossless_model_grants(sited) -> None:
    _, table = sited
    room = {(row["network"], row["site"]): float(row["least_headroom_kw"]) for row in table}
    for (network, site), kw in room.items():
        if network == "ac":
            assert kw <= room[("lindistflow", site)] + 1e-3


def test_the_map_shows_every_site_and_rings_the_best(sited) -> None:
    runs, table = sited
    values = {
        row["site"]: float(row["least_headroom_kw"]) for row in table if row["network"] == "ac"
    }
    told = {site: f"{value:.0f}" for site, value in values.items()}
    drawn = site_map(runs.base, values, told, "Firm headroom, kW")
    traces = {trace.get("name"): trace for trace in drawn["data"]}
    nodes, best = traces["Node"], max(values, key=values.__getitem__)
    assert len(nodes["x"]) == len(values)
    at = [text.partition("</b>")[0] for text in nodes["text"]].index(f"<b>{best}")
    assert (traces["Best site"]["x"], traces["Best site"]["y"]) == (
        [nodes["x"][at]],
        [nodes["y"][at]],
    )
    assert f"highest at {best}" in site_alt(values, "Firm headroom, kW")
    worst = site_map(runs.base, values, told, "Losses", least_is_best=True)
    ring = next(trace for trace in worst["data"] if trace.get("name") == "Best site")
    least = min(values, key=values.__getitem__)
    at = [text.partition("</b>")[0] for text in nodes["text"]].index(f"<b>{least}")
    assert ring["x"] == [nodes["x"][at]]
