"""The race in pictures: bars, the line nobody passes, loads against the headroom."""

from evdash.charts.race import LOOKS, load_alt, load_figure, load_rows, profit_alt, profit_figure
from evdash.horizon.inputs import prepare
from evdash.policies.race import race
from evdash.policies.registry import RULES
from tests.builders import line, make_scenario, vehicle


def raced():
    scenario = make_scenario(
        lines=(line("s", "a", rating=12.0),),
        vehicles=[vehicle(f"{n}", need_kwh=10.0) for n in range(4)],
    )
    return race(prepare(scenario), ("p1", "uncoordinated", "oracle"))


def test_bars_by_profit_and_the_line_at_the_most():
    found = raced()
    figure = profit_figure(found)
    (bars,) = figure["data"]
    assert bars["x"] == sorted(bars["x"])
    lawless = bars["y"].index("Uncoordinated<br>breaks limits")
    assert [shape != "" for shape in bars["marker"]["pattern"]["shape"]].index(True) == lawless
    assert [shape["x0"] for shape in figure["layout"]["shapes"]] == [found.most_profit]
    assert figure["layout"]["xaxis"]["range"][1] > max(bars["x"])
    assert f"${found.most_profit:,.2f}" in profit_alt(found)


def test_loads_stand_against_the_headroom():
    found = raced()
    figure = load_figure(found, ("p1", "uncoordinated", "llf"))
    assert [trace["name"] for trace in figure["data"]] == [
        "Headroom",
        "P1, the paper&#x27;s" if "&#x27;" in figure["data"][1]["name"] else "P1, the paper's",
        "Uncoordinated",
    ]
    assert len(figure["data"][1]["x"]) == len(figure["data"][1]["y"]) == 5
    assert "Uncoordinated up to 40.0 kW, above the headroom in 1 intervals" in load_alt(
        found, ("uncoordinated",)
    )
    assert load_rows(found)[0]["uncoordinated, kW"] == 40.0


def test_every_policy_has_a_look_of_its_own():
    assert set(LOOKS) == set(RULES)
    assert len(set(LOOKS.values())) == len(LOOKS)
