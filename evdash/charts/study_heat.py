"""What a study found along two axes, as a heat map with its values written in."""

from collections.abc import Sequence

from evdash.charts.style import FONT_PX, Figure, empty_note, figure, safe, value_axis

ROW_PX, LEAST_PX, MOST_PX = 46, 320, 760
MOST_WRITTEN = 150
"""With more cells than this the values are left to hovering and the table."""


def heat_figure(
    columns: Sequence[object],
    rows: Sequence[object],
    values: Sequence[Sequence[float | None]],
    titles: tuple[str, str, str],
    told: Sequence[Sequence[str]],
) -> Figure:
    """Medians by column and row (rows, columns); `titles` of columns, rows and the values, `told`
    the values in words."""
    written = len(rows) * len(columns) <= MOST_WRITTEN
    across, down, value = titles
    heat = {
        "type": "heatmap",
        "x": [safe(f"{label}") for label in columns],
        "y": [safe(f"{label}") for label in rows],
        "z": [[None if v is None else round(v, 6) for v in row] for row in values],
        "text": [[safe(cell) for cell in row] for row in told],
        "texttemplate": "%{text}" if written else "",
        "textfont": {"size": FONT_PX},
        "colorscale": "Cividis",
        "colorbar": {"title": {"text": safe(value), "side": "right"}, "thickness": 14},
        "hovertemplate": f"{safe(across)} %{{x}}<br>{safe(down)} %{{y}}<br>%{{text}}"
        "<extra></extra>",
        "xgap": 2,
        "ygap": 2,
    }
    empty = not any(v is not None for row in values for v in row)
    return figure(
        [heat],
        min(MOST_PX, max(LEAST_PX, 130 + ROW_PX * len(rows))),
        xaxis={**value_axis(safe(across)), "type": "category", "showgrid": False},
        yaxis={**value_axis(safe(down)), "type": "category", "showgrid": False},
        annotations=[empty_note("No day has ended yet.")] if empty else [],
    )


def heat_alt(
    columns: Sequence[object],
    rows: Sequence[object],
    values: Sequence[Sequence[float | None]],
    titles: tuple[str, str, str],
) -> str:
    """Where the highest and lowest cells are."""
    cells = [
        (value, rows[i], columns[j])
        for i, row in enumerate(values)
        for j, value in enumerate(row)
        if value is not None
    ]
    across, down, value = titles
    if not cells:
        return f"{value} by {across} and {down}: nothing to show yet."
    low, high = min(cells, key=lambda cell: cell[0]), max(cells, key=lambda cell: cell[0])
    return (
        f"{value} by {across} and {down}: from {low[0]:,.4g} at {across} {low[2]}, {down} {low[1]} "
        f"to {high[0]:,.4g} at {across} {high[2]}, {down} {high[1]}."
    )
