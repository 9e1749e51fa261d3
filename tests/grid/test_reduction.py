"""Named rows over station power: names, headroom, binding element, published values."""

import numpy as np
import pytest
from hypothesis import given

from evdash.domain.elements import Element
from evdash.domain.limits import LimitRows
from evdash.files.scenario_folder import read_scenario
from evdash.grid.lindistflow import voltage_pu
from evdash.grid.radial import radial_feeder
from evdash.grid.reduction import limit_rows
from tests.builders import PRESETS, line, make_scenario, names, node, scenarios

A, B = Element("node", "a"), Element("node", "b")


def way(**limits):
    """s - a - b with the station at b, and c beside it on a."""
    return make_scenario(
        nodes=[
            node("s"),
            node("a", load_kw=30, load_kvar=0),
            node("b", load_kw=60, load_kvar=80, rating_kva=limits.get("node_b")),
            node("c", load_kw=10, load_kvar=0, rating_kva=limits.get("node_c")),
        ],
        lines=[
            line("s", "a", 0.1, 0.1, limits.get("s_a")),
            line("b", "a", 0.2, 0.1, limits.get("b_a")),
            line("a", "c", 0.3, 0.1, limits.get("a_c")),
        ],
        station={"node": "b"},
        price=[0.1],
    )


def row(scenario, element):
    rows = limit_rows(scenario)
    return rows.limit_kw[0, names(rows.elements).index(element)]


def test_without_ratings_there_is_a_row_for_the_voltage_of_every_node_of_a_shared_way():
    assert set(names(limit_rows(way()).elements)) == {
        "voltage_min:a",
        "voltage_min:b",
        "voltage_min:c",
    }


def test_a_node_that_shares_no_line_with_the_station_has_no_row():
    scenario = make_scenario(
        nodes=[node("s"), node("a"), node("b", load_kw=50)], lines=[line("s", "a"), line("s", "b")]
    )
    assert names(limit_rows(scenario).elements) == ("voltage_min:a",)


def test_rating_of_the_stations_node_leaves_what_reactive_power_and_load_do_not_take():
    # sqrt(100² - 80²) = 60: the load alone takes all of it at 100 kVA, 90 of 150 at 170 kVA
    assert row(way(node_b=100), "node:b") == pytest.approx(0, abs=1e-9)
    assert row(way(node_b=170), "node:b") == pytest.approx(150 - 60)


def test_rating_of_another_node_is_no_row():
    assert "node:c" not in names(limit_rows(way(node_c=1)).elements)


def test_lines_on_the_way_have_rows_named_as_in_the_table_and_others_have_none():
    rows = limit_rows(way(s_a=170, b_a=170, a_c=1))
    assert {e for e in names(rows.elements) if e.startswith("line:")} == {"line:s-a", "line:b-a"}
    assert row(way(s_a=170), "line:s-a") == pytest.approx(150 - 100)  # 30 + 60 + 10 downstream
    assert row(way(b_a=170), "line:b-a") == pytest.approx(150 - 60)


def test_voltage_row_is_the_station_power_that_meets_the_limit():
    scenario = way()
    feeder, rows = radial_feeder(scenario), limit_rows(scenario)
    for element, limit_kw in zip(names(rows.elements), rows.limit_kw[0], strict=True):
        index = feeder.node_index(element.removeprefix("voltage_min:"))
        met = voltage_pu(scenario, feeder, np.array([limit_kw]))[0, index]
        assert met == pytest.approx(scenario.feeder.voltage_min_pu, abs=1e-12)


@given(scenario=scenarios())
def test_rows_are_finite_and_one_for_each_element(scenario):
    rows = limit_rows(scenario)
    assert len(set(rows.elements)) == len(rows.elements)
    assert rows.limit_kw.shape == (scenario.intervals, len(rows.elements))
    assert np.isfinite(rows.limit_kw).all()


def test_headroom_is_the_smallest_row_and_never_negative_and_binding_names_it():
    rows = LimitRows((A, B), np.ones((2, 1)), np.array([[5.0, 7.0], [9.0, 8.0], [-1.0, -4.0]]))
    assert rows.headroom_kw().tolist() == [5.0, 8.0, 0.0]
    assert rows.binding() == (A, B, B)
    assert rows.from_interval(1).headroom_kw().tolist() == [8.0, 0.0]


def test_headroom_respects_coefficients():
    rows = LimitRows((A, B), np.array([[1.0], [2.0]]), np.array([[5.0, 8.0]]))
    assert (rows.headroom_kw().tolist(), rows.binding()) == ([4.0], (B,))


def test_a_feeder_without_any_limit_in_reach_has_unlimited_headroom():
    scenario = make_scenario(lines=[line("s", "a", 0.0, 0.1)], price=[0.1, 0.1])
    rows = limit_rows(scenario)
    assert rows.elements == ()
    assert rows.headroom_kw().tolist() == [np.inf, np.inf]
    assert rows.binding() == (None, None)


# Station headroom in whole kW of the 13-node feeder by linearised DistFlow, computed once by a
# program apart from this one: voltage limits alone, power factor 0.9, capacitors on.
PUBLISHED_KW = {
    (1.00, 0.6): {"633": 975, "634": 243, "645": 1527, "671": 1277, "675": 1067, "652": 441},
    (1.02, 0.6): {"633": 3738, "634": 932, "671": 3758, "675": 2935, "652": 1298},
    (1.02, 0.8): {"633": 2299, "634": 573, "671": 2213, "675": 1774, "652": 764},
    (1.02, 0.9): {"632": 2837, "634": 394, "645": 2375, "646": 1745, "671": 1440},
    (1.02, 1.0): {
        **{"632": 1335, "633": 860, "634": 214, "645": 1335, "646": 1335, "671": 668},
        **{"692": 668, "675": 613, "680": 668, "684": 460, "611": 405, "652": 231},
    },
    (1.03, 1.0): {"633": 2262, "634": 564, "671": 1927, "675": 1560, "652": 665},
}


@pytest.fixture(scope="module")
def ieee13():
    return read_scenario(PRESETS / "summer-weekday")


@pytest.mark.parametrize(
    ("source_pu", "scale", "station", "expected"),
    [(*key, station, kw) for key, row in PUBLISHED_KW.items() for station, kw in row.items()],
)
def test_headroom_agrees_with_the_comparison_values(ieee13, source_pu, scale, station, expected):
    lines = tuple(row.model_copy(update={"rating_kva": None}) for row in ieee13.lines)
    feeder = {"source_voltage_pu": source_pu, "load_scale": scale}
    scenario = ieee13.replacing(
        lines=lines,
        feeder=ieee13.feeder.model_copy(update=feeder),
        station=ieee13.station.model_copy(update={"node": station}),
    )
    at_full_load = int(np.argmax(scenario.load_pu))
    assert limit_rows(scenario).headroom_kw()[at_full_load] == pytest.approx(expected, abs=1.5)


def test_bundled_days_bind_where_they_say(ieee13):
    rows = limit_rows(ieee13)
    assert set(names(rows.binding())) == {"line:633-634"}
    # 500 kVA less a load of 400 kW at power factor 0.9
    full = 500**2 - (400 * np.sqrt(1 - 0.81) / 0.9) ** 2
    assert rows.headroom_kw()[18] == pytest.approx(np.sqrt(full) - 400)
    binding = limit_rows(read_scenario(PRESETS / "voltage-limited")).binding()
    assert set(names(binding[12:])) == {"voltage_min:652"}
