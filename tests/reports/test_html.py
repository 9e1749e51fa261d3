"""The report: complete, self-contained, and nobody's text ever more than text."""

import json
import re
from html.parser import HTMLParser

import pytest

from evdash.charts.standalone import plotly_script
from evdash.domain.scenario import Scenario
from evdash.errors import InputError
from evdash.horizon.day import start_day
from evdash.metrics.ageing import Thermal
from evdash.metrics.records import vehicle_records
from evdash.reports.account import account, transformers, verdict_on
from evdash.reports.html import cell, report_html
from evdash.reports.tables import loading_rows, reason_rows, violation_rows, voltage_rows
from tests.builders import make_scenario, node
from tests.reports.conftest import HOSTILE, account_of

VOID = {"meta", "img", "br", "hr", "link", "input"}


class Reader(HTMLParser):
    """The report as a parser of Python's own reads it."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text: list[str] = []
        self.scripts: list[str] = []

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        (self.scripts if self.open[-1:] == ["script"] else self.text).append(data)

    @property
    def words(self) -> str:
        return " ".join(" ".join(self.text).split())


def read(text: str) -> Reader:
    reader = Reader()
    reader.feed(text)
    reader.close()
    assert reader.open == []
    return reader


@pytest.fixture(scope="module")
def page(usual) -> Reader:
    return read(report_html(usual))


def test_it_tells_the_totals_and_where_it_comes_from(page, usual):
    day, summary = usual.totals, json.loads(usual.files["summary.json"])
    for told in (
        f"{day.admitted} of {day.arrived}",
        f"${day.profit:,.2f}",
        f"{day.energy_delivered_kwh:,.0f} kWh",
        summary["scenario_sha256"],
        summary["versions"]["highspy"],
        "python -m evdash audit",
        "IEEE C57.91",
        "Ambient temperature, all day 30 °C",
    ):
        assert told in page.words


def test_everyone_who_asked_and_every_reason_is_told(page, usual):
    records = vehicle_records(usual.trace)
    assert all(record.vehicle in page.words for record in records)
    refused = [record for record in records if record.status == "refused"]
    assert sum(row["Vehicles"] for row in reason_rows(usual)) == len(refused)
    energy = sum(row["Energy refused, kWh"] for row in reason_rows(usual))
    assert energy == pytest.approx(sum(r.request.need_kwh for r in refused), abs=0.2)


def test_it_asks_for_nothing_outside(page):
    linked = [
        value
        for _, attributes in page.tags
        for name, value in attributes.items()
        if name in ("src", "href", "action", "data", "poster", "srcset")
    ]
    assert linked
    assert all(value.startswith("#") for value in linked)
    policy = next(a["content"] for tag, a in page.tags if a.get("http-equiv"))
    assert "default-src 'none'" in policy
    assert "url(" not in re.sub(r"<script.*?</script>", "", " ".join(page.text), flags=re.S)


def test_plotly_is_there_once_and_every_chart_has_its_figure_and_words(page):
    whole = "".join(page.scripts)
    assert whole.count(plotly_script()[:2000]) == 1
    figures = json.loads(next(s for s in page.scripts if s.startswith("{") and "schedule" in s))
    charts = [a for tag, a in page.tags if a.get("role") == "img"]
    assert {a["id"] for a in charts} == {f"chart-{name}" for name in figures}
    assert len(figures) >= 7
    assert all(len(a["aria-label"]) > 40 for a in charts)


def test_no_two_parts_go_by_one_name_and_every_link_leads_somewhere(page):
    names = [a["id"] for _, a in page.tags if "id" in a]
    assert len(names) == len(set(names))
    assert {a["href"].removeprefix("#") for tag, a in page.tags if tag == "a"} <= set(names)


def test_a_users_text_stays_text(hostile):
    text = report_html(hostile)
    page = read(text)
    assert not [tag for tag, _ in page.tags if tag == "img"]
    assert not [a for _, a in page.tags if "onerror" in a]
    assert f"={HOSTILE}" in page.words
    assert HOSTILE[:40] in page.words
    # scripts: Plotly's, ours and two of data, and none begun by a name
    assert sum(tag == "script" for tag, _ in page.tags) == 4
    assert "<img src=y" not in text


def test_broken_promises_and_their_cause_stand_in_the_head(hostile):
    assert hostile.totals.broken
    page = read(report_html(hostile))
    assert f"{hostile.totals.broken} promise" in page.words
    assert "2 of the chargers stop working" in page.words


def test_limits_exceeded_in_ac_are_told_with_depth_and_hours(usual):
    row = next(row for row in violation_rows(usual) if row["Model"] == "AC")
    mine = [b for b in usual.verdict.ac if str(b.element) == "line:633-634"]
    assert row["For, h"] == len(mine)
    assert row["Beyond by"] == f"{max(b.depth for b in mine):,.1f} kVA"
    assert row["Without charging"] == "held"
    rating = next(row for row in loading_rows(usual) if "rating" in row["Loading"])
    assert rating["With charging, h"] == len({b.interval for b in mine})
    assert rating["Without charging, h"] == 0


def test_durations_count_the_cells_of_the_voltage_table(usual):
    row = next(row for row in voltage_rows(usual) if row["Voltage"].startswith("below 0.98"))
    low = usual.verdict.flow.voltage_pu < 0.98
    assert row["Node-hours"] == low.sum()
    assert row["With charging, h"] == low.any(axis=1).sum()


def test_the_transformer_and_its_ambient_can_be_chosen(usual):
    scenario: Scenario = usual.scenario
    assert next(iter(transformers(scenario))) == "633-634"
    warm = account(usual.trace, usual.verdict, usual.label, thermal=Thermal(ambient_c=40.0))
    assert warm.aged.with_station.highest_c == pytest.approx(usual.aged.with_station.highest_c + 10)
    other = account(usual.trace, usual.verdict, usual.label, transformer="650-632")
    assert (other.aged.name, other.aged.rating_kva) == ("650-632", 5260.0)
    with pytest.raises(InputError, match="should be a line with a rating"):
        account(usual.trace, usual.verdict, usual.label, transformer="671-692")


def test_without_ratings_or_vehicles_it_says_so():
    empty = account_of(make_scenario(nodes=[node("s"), node("a", load_kw=5)]))
    page = read(report_html(empty))
    for told in (
        "No line, transformer or node has a rating",
        "Nobody was refused",
        "no ageing told",
    ):
        assert told in page.words


def test_a_day_that_is_not_over_is_refused():
    trace = start_day(make_scenario())
    with pytest.raises(InputError, match="run it to its end"):
        verdict_on(trace)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.0, "0"),
        (None, ""),
        (1234, "1,234"),
        (-0.5, "\u22120.5"),
        ("=1+1", "=1+1"),
        (12345.6, "12,345.6"),
        (3e-5, "0.00003"),
    ],
)
def test_cells(value, shown):
    assert cell(value) == shown
