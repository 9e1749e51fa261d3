"""What stands in a report, section by section: sentences, charts, tables."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from evdash.reports import charts, tables, words
from evdash.reports.account import Account
from evdash.reports.charts import Chart
from evdash.reports.tables import Row


@dataclass(frozen=True, slots=True)
class Table:
    """Rows under a caption, or `empty` said where there are none; long ones open on demand."""

    caption: str
    rows: Sequence[Row]
    empty: str = ""
    is_long: bool = False


@dataclass(frozen=True, slots=True)
class Section:
    """A part of the report: sentences by subject and others, then charts, then tables."""

    name: str
    title: str
    lines: Sequence[str] = ()
    subjects: Mapping[str, Sequence[str]] = field(default_factory=dict)
    charts: Sequence[Chart] = ()
    tables: Sequence[Table] = ()


def sections(account: Account) -> list[Section]:
    """The report in its order: what went in, what was decided, what it did to the feeder."""
    return [
        _inputs(account),
        _figures(account),
        _decisions(account),
        _schedule(account),
        _feeder(account),
        _durations(account),
        _transformer(account),
        _ledger(account),
    ]


def _inputs(account: Account) -> Section:
    scenario = account.scenario
    subjects = {
        "Feeder": words.feeder_words(scenario),
        "Station": words.station_words(scenario),
        "Day": words.profile_words(scenario),
        "Vehicles": words.arrivals_words(account),
        "Happened": words.event_lines(account),
        "Edited": words.edit_lines(account),
        "Decided": words.decided_words(account),
    }
    told = {subject: lines for subject, lines in subjects.items() if lines}
    return Section("inputs", "What went in", subjects=told)


def _figures(account: Account) -> Section:
    table = Table("Figures", tables.figure_rows(account))
    return Section("figures", "The day in figures", tables=[table])


def _decisions(account: Account) -> Section:
    worths = [f"Worth: {text}" for text in account.worths]
    return Section(
        "decisions",
        "Who was admitted, and why not",
        lines=worths,
        charts=[charts.admissions_chart(account)],
        tables=[
            Table("By price option", tables.option_rows(account)),
            Table("Refusals by reason", tables.reason_rows(account), "Nobody was refused."),
            Table("Everyone who asked", tables.decision_rows(account), "Nobody asked.", True),
        ],
    )


def _schedule(account: Account) -> Section:
    return Section(
        "schedule",
        "Who charged when, and at which load",
        lines=[words.tightest_words(account)],
        charts=[
            charts.schedule_chart(account),
            charts.load_chart(account),
            charts.headroom_chart(account),
        ],
    )


def _feeder(account: Account) -> Section:
    return Section(
        "feeder",
        "The feeder",
        charts=[
            charts.voltages_chart(account),
            charts.gap_chart(account),
            charts.feeder_chart(account),
        ],
        tables=[
            Table(
                "Limits exceeded, by element and cause",
                tables.violation_rows(account),
                "None, in the linearised model and in AC.",
            )
        ],
    )


def _durations(account: Account) -> Section:
    return Section(
        "durations",
        "How long and how far beyond thresholds",
        lines=[
            "By AC power flow (pandapower), interval means, without charging and with it. Hours "
            "count while at least one node or line is beyond; node-hours and line-hours count "
            "each of them."
        ],
        tables=[
            Table("Voltages", tables.voltage_rows(account)),
            Table(
                "Loading of lines and transformers",
                tables.loading_rows(account),
                "No line or transformer has a rating.",
            ),
            Table("Every node", tables.node_rows(account), "AC has no solution.", True),
            Table(
                "Every rated line and transformer",
                tables.line_rows(account),
                "No line or transformer has a rating.",
                True,
            ),
        ],
    )


def _transformer(account: Account) -> Section:
    title = "Ageing of the station's transformer by IEEE C57.91"
    chart = charts.hot_spot_chart(account)
    if chart is None or account.aged is None:
        known = "No line on the station's way has a rating, or AC has no solution: no ageing told."
        return Section("transformer", title, lines=[known])
    name = account.aged.name
    return Section(
        "transformer",
        title,
        lines=[
            f"{name} is taken for the station's transformer; a scenario does not say which of its "
            "lines are transformers. Its load is the AC power flow's, the mean of each interval. "
            "The day is taken to come again and again, so that it ends as warm as it begins.",
            "Hot spot = ambient + top-oil rise + hot-spot rise, each following its ultimate value "
            "with its time constant. Ageing F = exp(15000/383 − 15000/(hot spot in °C + 273)): 1 "
            "at 110 °C, about twice as fast for every 7 K more.",
        ],
        charts=[chart],
        tables=[
            Table("What the day costs it", tables.ageing_rows(account)),
            Table("Assumptions; replace them by the maker's data", tables.thermal_rows(account)),
        ],
    )


def _ledger(account: Account) -> Section:
    return Section(
        "ledger",
        "The ledger of promises",
        lines=[words.promises_line(account)[1]],
        tables=[
            Table("Every promise made", tables.ledger_rows(account), "No promise was made.", True)
        ],
    )
