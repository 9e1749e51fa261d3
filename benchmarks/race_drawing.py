"""The race in one picture: what each policy earns of what the oracle could, by preset."""

from collections.abc import Mapping, Sequence
from pathlib import Path

Bar = tuple[float, float]
COLOURS = {
    "bid-price": "#CC79A7",
    "p1": "#0072B2",
    "llf": "#56B4E9",
    "edf": "#E69F00",
    "fcfs": "#F0E442",
}
"""Okabe and Ito's, as in the app."""
WIDTH, LEFT, ROW, GAP, TOP, REACH = 760, 150, 15, 16, 34, 520
LEAST = 0.7
"""Where the bars begin; what lies below it is written only."""


def save_svg(shares: Mapping[str, Mapping[str, Bar]], path: Path) -> None:
    """Draw mean shares and half widths of their intervals of confidence by preset and policy."""
    rows, y = [_scale()], TOP
    for preset, bars in shares.items():
        rows.append(_text(LEFT - 8, y + ROW * len(bars) / 2 + 5, preset, "end"))
        for policy, bar in bars.items():
            rows.append(_bar(y, policy, bar))
            y += ROW
        y += GAP
    size = f'width="{WIDTH}" height="{y + 8}" viewBox="0 0 {WIDTH} {y + 8}"'
    path.write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" {size} font-family="sans-serif" '
        f'font-size="12">\n<rect width="100%" height="100%" fill="white"/>\n'
        + "\n".join(rows)
        + "\n</svg>\n",
        encoding="utf-8",
    )


def _x(share: float) -> float:
    return LEFT + REACH * (max(LEAST, share) - LEAST) / (1 - LEAST)


def _bar(y: float, policy: str, bar: Bar) -> str:
    share, half = bar
    end, colour = _x(share), COLOURS[policy]
    told = f"{policy} {share:.3f}"
    whisker = (
        f'<line x1="{_x(share - half):.1f}" x2="{_x(share + half):.1f}" y1="{y + 6}" y2="{y + 6}" '
        'stroke="black"/>'
        if share > LEAST
        else ""
    )
    return (
        f'<rect x="{LEFT}" y="{y}" width="{end - LEFT:.1f}" height="{ROW - 3}" fill="{colour}"/>'
        + whisker
        + _text(max(end, _x(share + half)) + 5, y + 10, told, "start", 11)
    )


def _scale() -> str:
    marks: Sequence[float] = (0.7, 0.8, 0.9, 1.0)
    lines = [
        f'<line x1="{_x(m):.1f}" x2="{_x(m):.1f}" y1="{TOP - 6}" y2="100%" stroke="#bbb"/>'
        + _text(_x(m), TOP - 12, f"{m:.1f}", "middle")
        for m in marks
    ]
    return "\n".join(lines)


def _text(x: float, y: float, text: str, anchor: str, size: int = 12) -> str:
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" font-size="{size}">{text}</text>'
