"""Growth of a day's time with vehicles, intervals and feeder nodes: a table and an SVG."""

import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from statistics import median

from rich.box import MARKDOWN
from rich.table import Table

from benchmarks.cases import bundled_day, in_quarter_hours, large_day, with_lateral
from evdash.domain.scenario import Scenario
from evdash.files.overrides import edit_scenario
from evdash.horizon.day import run_day, start_day
from evdash.scheduling.p1 import p1_policy

WIDTH, HEIGHT, MARGIN = 300, 200, 40
TOP_SECONDS = 4.0


@dataclass(frozen=True, slots=True)
class Point:
    """A median day at `size` of what grows, s of the processor."""

    what: str
    size: int
    seconds: float


def measured(seeds: int) -> list[Point]:
    """Median days as one thing grows and the others stay."""
    return [
        Point(what, size, median(_processor_seconds(day) for day in days))
        for what, size, days in _days(range(1, seeds + 1))
    ]


def _days(seeds: Sequence[int]) -> Iterator[tuple[str, int, list[Scenario]]]:
    for vehicles in (50, 100, 200, 400, 800, 1600):
        settings = {"arrivals.vehicles_per_day": float(vehicles), "station.chargers": 200}
        yield "vehicles a day", vehicles, [edit_scenario(bundled_day(s), settings) for s in seeds]
    yield "intervals, 1,000 vehicles", 24, [large_day(s) for s in seeds]
    yield "intervals, 1,000 vehicles", 96, [in_quarter_hours(large_day(s)) for s in seeds]
    for nodes in (13, 50, 100, 250, 500):
        yield "feeder nodes", nodes, [with_lateral(bundled_day(s), nodes) for s in seeds]


def _processor_seconds(scenario: Scenario) -> float:
    began = time.process_time()
    run_day(start_day(scenario), p1_policy())
    return time.process_time() - began


def table(points: Sequence[Point]) -> Table:
    """The points as a table."""
    shown = Table(title="growth: a median day, s of the processor", box=MARKDOWN)
    for heading in ("what grows", "to", "day"):
        shown.add_column(heading, justify="right")
    for point in points:
        shown.add_row(point.what, str(point.size), f"{point.seconds:.3f}")
    return shown


def save_svg(points: Sequence[Point], path: Path) -> None:
    """One panel for each thing that grows, all to the same scale."""
    kinds = list(dict.fromkeys(point.what for point in points))
    panels = [_panel([p for p in points if p.what == kind], i) for i, kind in enumerate(kinds)]
    size = f'width="{len(kinds) * WIDTH}" height="{HEIGHT}"'
    style = 'font-family="sans-serif" font-size="11" fill="#333"'
    path.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} {style}>\n'
        '<rect width="100%" height="100%" fill="white"/>\n' + "\n".join(panels) + "\n</svg>\n"
    )


def _panel(points: Sequence[Point], number: int) -> str:
    left, bottom = number * WIDTH + MARGIN, HEIGHT - MARGIN
    across = (WIDTH - 1.5 * MARGIN) / max(point.size for point in points)
    up = (bottom - MARGIN / 2) / TOP_SECONDS
    at = [(left + across * point.size, bottom - up * point.seconds) for point in points]
    line = " ".join(f"{x:.1f},{y:.1f}" for x, y in at)
    marks = [f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="#0072b2"/>' for x, y in at]
    sizes = [
        f'<text x="{x:.1f}" y="{bottom + 14}" text-anchor="middle">{point.size}</text>'
        for (x, _), point in zip(at, points, strict=True)
        if point.size >= max(p.size for p in points) / 4
    ]
    grid = [
        f'<path d="M{left} {bottom - up * s:.1f}H{left + WIDTH - 1.5 * MARGIN}" stroke="#ddd"/>'
        f'<text x="{left - 6}" y="{bottom - up * s + 4:.1f}" text-anchor="end">{s} s</text>'
        for s in range(int(TOP_SECONDS) + 1)
    ]
    curve = f'<polyline points="{line}" fill="none" stroke="#0072b2" stroke-width="2"/>'
    title = f'<text x="{left}" y="{HEIGHT - 8}">{points[0].what}</text>'
    return "\n".join([*grid, curve, *marks, *sizes, title])
