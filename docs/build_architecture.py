"""Writes `docs/architecture.md` and its drawing from `pyproject.toml`'s layers and the way below.

Run `python docs/build_architecture.py` after moving what a vehicle passes on its way. A test holds
both files to this one, and the way to the functions that a real day enters, in their order.
"""

import re
import sys
import tomllib
from dataclasses import dataclass
from html import escape
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

ROOMS = {
    "api": "the library: `evdash.load(…)`, days, tables, plots",
    "cli": "commands, their options and what they print",
    "ui": "the pages of the app",
    "reports": "report, workbook, charging profiles, pandapower network",
    "audit": "a run folder worked out again, sharing no code with scheduling",
    "imports": "people's own networks, prices and vehicles",
    "studies": "many days, shared out over processes",
    "files": "scenario and run folders: read, checked, written",
    "charts": "figures, as plain data for Plotly",
    "store": "runs kept in one SQLite file",
    "policies": "who decides: P1 and others, of our own or from outside",
    "explain": "why, and what would have made a difference",
    "metrics": "what a day came to: figures, ledger, verdict on limits",
    "horizon": "the day: arrivals, requests, steps, events, edits",
    "scheduling": "P1: its equations, and how it is solved",
    "checker": "the independent referee of every plan",
    "grid": "the feeder: linearised or AC, reduced to rows over station power",
    "domain": "data that all share: scenario, requests, plans, elements",
    "errors": "the few errors meant for people",
}


@dataclass(frozen=True, slots=True)
class Stage:
    """One stage of a vehicle's way: a function, and what becomes of the vehicle there."""

    function: str
    what: str

    @property
    def module(self) -> str:
        return self.function.rpartition(".")[0]

    @property
    def room(self) -> str:
        return self.function.split(".")[1]

    @property
    def file(self) -> str:
        return f"{self.module.replace('.', '/')}.py"


WAY = (
    Stage(
        "evdash.files.scenario_folder.read_scenario",
        "The day is read from its files and checked, all faults at once.",
    ),
    Stage(
        "evdash.horizon.arrivals.arrivals_of",
        "It arrives at a minute of the day: as recorded, or drawn with the seed.",
    ),
    Stage(
        "evdash.horizon.requests.request_for",
        "It asks: so many kWh at the grid, back by that interval, for that price. Who cannot be "
        "served by anyone is refused at the door.",
    ),
    Stage(
        "evdash.grid.reduction.limit_rows",
        "The feeder becomes rows over station power, each named by the element it stands for.",
    ),
    Stage(
        "evdash.horizon.advance.snapshot_of",
        "An interval begins. Whoever decides is told what is known now, and nothing of who comes "
        "later.",
    ),
    Stage(
        "evdash.scheduling.problem.problem_of",
        "Contracts and newcomers become one program, P1.",
    ),
    Stage(
        "evdash.scheduling.fast.solver.solve_fast",
        "P1 is solved: who is admitted, who charges when.",
    ),
    Stage(
        "evdash.scheduling.clean.cleaned",
        "The plan is made exact to the last bit.",
    ),
    Stage(
        "evdash.checker.plans.plan_problems",
        "The referee walks the feeder and counts every promise anew. A plan that breaks anything "
        "is not carried out: the last plan's tail is.",
    ),
    Stage(
        "evdash.horizon.advance.advance",
        "The first interval is carried out; the rest is the tail, certified for the next step.",
    ),
    Stage(
        "evdash.files.run_export.run_files",
        "The day is over, and the run's folder is written.",
    ),
    Stage(
        "evdash.metrics.records.vehicle_records",
        "Its row in `vehicles.csv`: what it was promised, what it got, what it paid.",
    ),
    Stage(
        "evdash.audit.audit.audit_run",
        "From those files alone everything is worked out again.",
    ),
    Stage(
        "evdash.reports.account.account",
        "The report is put together.",
    ),
    Stage(
        "evdash.reports.html.report_html",
        "It is told to whoever asks for it, in one file.",
    ),
)

CHANGES = {
    "an equation of P1": "`evdash/scheduling/equations.py`, as the paper has it; as it is solved, "
    "`evdash/scheduling/fast/relaxation.py`",
    "what energy costs, a new price component": "`evdash/domain/tariff.py`, whose first lines say "
    "where else",
    "what drivers pay, a new price option's terms": "`evdash/domain/scenario.py` `PriceOption`, "
    "`evdash/domain/vehicles.py` `Request`, `evdash/horizon/requests.py`; on the Live page "
    "`evdash/ui/settings.py`; the referee's own: `evdash/audit/asked.py`",
    "a limit of the feeder": "`evdash/grid/reduction.py` (linearised), `evdash/grid/aclimits.py` "
    "`ac_headroom` (AC), and the referees: `evdash/checker/feeder.py`, `evdash/grid/acbreaches.py`",
    "the words of a refusal": "`evdash/domain/refusal.py`",
    "the words of an explanation": "`evdash/explain/causes_told.py`, "
    "`evdash/explain/remedies_told.py`",
    "the name of an element in words": "`evdash/domain/words.py`",
    "a field of the scenario": "declared once in `evdash/domain/scenario.py`; files, documentation "
    "and the Scenario page's form follow",
    "what happens in a day under way": "`evdash/domain/events.py`, `evdash/horizon/in_force.py`, "
    "`evdash/horizon/happen.py`",
    "a figure of a day": "`evdash/metrics/service.py`",
    "who decides": "a function of one's own: [policies.md](policies.md)",
}

PAGE = """\
# Architecture

Written by `docs/build_architecture.py`. Rooms are the folders of `evdash/`; imports go downwards
only, which import-linter holds. The numbers are the stages of a vehicle's way.

![Rooms in layers, and a vehicle's way through them](architecture.svg)

## A vehicle's way, from its arrival to the report

`tests/test_architecture.py` runs a day and its report, and sees these functions entered in this
order.

| | function | what becomes of the vehicle |
| --- | --- | --- |
{way}

Two models of the feeder answer alike (`evdash/horizon/networks.py`): linearised DistFlow, the
paper's, and full AC power flow. Whoever decides (`evdash/policies/registry.py`) answers a
`Snapshot` with a `Plan` (`evdash/domain/plan.py`), and no plan counts before the referee has passed
it (`evdash/horizon/day.py` `certified_plan`). What changes a day under way goes one way each: an
edit through `evdash/horizon/revise.py`, an event through `evdash/horizon/happen.py`; both certify
the tail anew. Each equation of the paper has a function, listed in [equations.md](equations.md).

## Rooms

| room | what is in it |
| --- | --- |
{rooms}

## Where to change what

| | where |
| --- | --- |
{changes}
"""


def layers() -> list[list[str]]:
    """The rooms side by side, layer by layer, the highest first."""
    settings = tomllib.loads((HERE.parent / "pyproject.toml").read_text(encoding="utf-8"))
    (contract,) = (c for c in settings["tool"]["importlinter"]["contracts"] if c["id"] == "layers")
    named = [layer.replace(":", "|").split("|") for layer in contract["layers"]]
    return [[room for name in layer if (room := name.strip(" ()")) in ROOMS] for layer in named]


def page() -> str:
    """`docs/architecture.md`."""
    way = "\n".join(
        f"| {n} | `{one.file}` `{one.function.rpartition('.')[2]}` | {one.what} |"
        for n, one in enumerate(WAY, 1)
    )
    rooms = "\n".join(f"| `{room}` | {what} |" for room, what in ROOMS.items())
    changes = "\n".join(f"| {what} | {where} |" for what, where in CHANGES.items())
    return PAGE.format(way=way, rooms=rooms, changes=changes)


WIDTH, HEIGHT, GAP, EDGE = 760, 46, 8, 10
STYLE = """
  text { font: 15px system-ui, sans-serif; fill: #24292f }
  .room { fill: #f6f8fa; stroke: #8c959f }
  .stage { fill: #0072b2 }
  .what { font-size: 12px; fill: #57606a }
  .number { font-size: 12px; font-weight: 600; fill: #fff; text-anchor: middle }
  @media (prefers-color-scheme: dark) {
    text { fill: #e6edf3 } .what { fill: #9198a1 } .room { fill: #161b22; stroke: #768390 }
  }
"""


def drawing() -> str:
    """`docs/architecture.svg`: a box a room, a row a layer, and in each the stages of the way."""
    parts, top = [], EDGE
    for layer in layers():
        if not layer:
            continue
        wide = (WIDTH - 2 * EDGE - GAP * (len(layer) - 1)) / len(layer)
        for place, room in enumerate(layer):
            left = EDGE + place * (wide + GAP)
            parts.append(_room(room, left, top, wide))
        top += HEIGHT + GAP
    height = top - GAP + EDGE
    label = "Rooms of evdash in layers, and in each the numbered stages of a vehicle's way"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}" role="img" '
        f'aria-label="{escape(label)}">\n<style>{STYLE}</style>\n' + "\n".join(parts) + "\n</svg>\n"
    )


def _room(room: str, left: float, top: float, wide: float) -> str:
    middle, what = top + HEIGHT / 2, escape(re.split("[,:]", ROOMS[room])[0])
    stages = [n for n, one in enumerate(WAY, 1) if one.room == room]
    right = {n: left + wide - 20 - 25 * back for back, n in enumerate(reversed(stages))}
    marks = "".join(
        f'<circle class="stage" cx="{x:.0f}" cy="{middle:.0f}" r="11"/>'
        f'<text class="number" x="{x:.0f}" y="{middle + 4:.0f}">{n}</text>'
        for n, x in right.items()
    )
    return (
        f'<rect class="room" x="{left:.0f}" y="{top:.0f}" width="{wide:.0f}" height="{HEIGHT}" '
        f'rx="6"/><text x="{left + 14:.0f}" y="{middle - 3:.0f}">{room}</text>'
        f'<text class="what" x="{left + 14:.0f}" y="{middle + 15:.0f}">{what}</text>{marks}'
    )


def files() -> dict[str, str]:
    """What is written, by name in `docs/`."""
    return {"architecture.md": page(), "architecture.svg": drawing()}


if __name__ == "__main__":
    for name, text in files().items():
        (HERE / name).write_text(text, encoding="utf-8", newline="")
