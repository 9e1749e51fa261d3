"""The report: one HTML file that needs nothing else, to be read, printed and kept."""

import base64
import hashlib
from functools import cache
from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from evdash.charts.standalone import plotly_script, templates
from evdash.domain.words import money
from evdash.reports.account import Account
from evdash.reports.charts import Chart
from evdash.reports.sections import sections
from evdash.reports.words import limit_lines, period, promises_line

HERE = Path(__file__).parent / "page"
MINUS = "\u2212"
SMALL = 1e-4
"""Smaller numbers would be told with an exponent."""


def report_html(account: Account) -> str:
    """The whole report. Everything in it that is somebody's text is escaped by the template."""
    page = _environment().get_template("report.html.j2")
    chapters = sections(account)
    charts = [chart for chapter in chapters for chart in chapter.charts]
    scripts = [plotly_script(), (HERE / "report.js").read_text(encoding="utf-8")]
    return page.render(
        account=account,
        scenario=account.scenario,
        period=period(account.scenario),
        promises=promises_line(account),
        limits=limit_lines(account),
        figures=_figures(account),
        sections=chapters,
        style=Markup((HERE / "report.css").read_text(encoding="utf-8")),  # noqa: S704 - our own
        scripts=[Markup(script) for script in scripts],  # noqa: S704 - ours and Plotly's
        script_hashes=[_csp_hash(script) for script in scripts],
        data={chart.name: _spec(chart) for chart in charts},
        templates=templates(),
    )


def _figures(account: Account) -> list[tuple[str, str]]:
    """The day in a handful of figures."""
    day = account.totals
    return [
        ("Admitted", f"{day.admitted:,} of {day.arrived:,}"),
        ("Promises broken", f"{day.broken:,}"),
        ("Energy delivered", f"{day.energy_delivered_kwh:,.0f} kWh"),
        ("Highest station power", f"{day.peak_station_kw:,.0f} kW"),
        ("Revenue", money(day.revenue)),
        ("Energy cost", money(day.energy_cost)),
        ("Profit", money(day.profit)),
    ]


def _spec(chart: Chart) -> dict[str, object]:
    return {"data": chart.figure["data"], "layout": chart.figure["layout"]}


def _csp_hash(script: str) -> str:
    """What a page's Content-Security-Policy calls a script that may run."""
    return f"sha256-{base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()}"


@cache
def _environment() -> Environment:
    environment = Environment(
        loader=FileSystemLoader(HERE),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["cell"] = cell
    environment.tests["numeric"] = is_numeric
    return environment


def is_numeric(value: object) -> bool:
    """Whether a cell is set to the right."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def cell(value: object) -> str:
    """A cell's text: numbers with thousands parted, nothing where there is nothing."""
    if value is None:
        return ""
    if isinstance(value, int) and not isinstance(value, bool):
        return f"{value:,}".replace("-", MINUS)
    if isinstance(value, float):
        shown = (
            f"{value:,.10g}" if abs(value) >= SMALL or not value else f"{value:.10f}".rstrip("0")
        )
        return shown.replace("-", MINUS)
    return str(value)
