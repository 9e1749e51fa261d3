"""Room for legends: as many lines as plotly makes of them, seen in Chromium at these widths."""

import pytest

from evdash.charts.drawn import Drawn
from evdash.charts.legend import legend_lines, names_of, roomy
from evdash.charts.style import MARGIN, fixed_figure

VOLTAGES = ["Highest node", "Lowest node, linearised", "Lowest node, AC", "Outside limits in AC"]
LOAD = ["Station", "Plan", "Headroom", "Feeder load", "Price"]


@pytest.mark.parametrize(
    ("names", "plot_px", "lines"),
    [
        (VOLTAGES, 900, 1),
        (VOLTAGES, 510, 2),
        (VOLTAGES, 295, 4),
        (LOAD, 900, 1),
        (LOAD, 410, 2),
        (LOAD[:1], 100, 0),
    ],
)
def test_a_legend_has_the_lines_plotly_gives_it(names: list[str], plot_px: int, lines: int) -> None:
    assert legend_lines(names, plot_px) == lines


def figure(names: list[str], **layout: object) -> dict[str, object]:
    traces = [{"type": "scatter", "name": name} for name in names]
    return fixed_figure([*traces, {"type": "heatmap", "name": "map"}], 500, MARGIN, **layout)


def test_a_narrow_chart_grows_by_the_lines_of_its_legend() -> None:
    wide, narrow = roomy(figure(VOLTAGES), 1000), roomy(figure(VOLTAGES), 380)
    assert (wide["height"], wide["margin"]) == (500, {**MARGIN, "autoexpand": False})
    assert narrow["margin"]["t"] == 4 * 20 + 26
    assert narrow["height"] - narrow["margin"]["t"] == 500 - MARGIN["t"]  # the chart itself stays


def test_what_is_not_in_the_legend_needs_no_room() -> None:
    assert names_of(figure(["a", "b"])) == ["a", "b"]
    assert roomy(figure(VOLTAGES, showlegend=False), 300)["height"] == 500


def test_a_drawn_figure_has_the_room() -> None:
    drawn = Drawn(figure(VOLTAGES), 380).to_dict()
    assert drawn["layout"]["height"] > 500
    assert drawn["layout"]["width"] == 380
