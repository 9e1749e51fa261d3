"""Writes `docs/studies.md` from the declarations of a study's fields, keys and metrics.

Run `python docs/build_studies_doc.py` after changing one; a test holds both in step.
"""

import sys
from pathlib import Path

from pydantic import BaseModel
from pydantic.fields import FieldInfo

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))
sys.path.insert(0, str(HERE))

from build_scenario_doc import bounds  # noqa: E402 - the paths above make it so

from evdash.domain.study import Axis, Case, Seeds, Study  # noqa: E402
from evdash.studies.keys import STUDY_KEYS  # noqa: E402
from evdash.studies.measures import MEASURES, TEXTS  # noqa: E402

INTRODUCTION = """\
# Studies

Written by `docs/build_studies_doc.py` from the declarations in `evdash/domain/study.py`,
`evdash/studies/keys.py` and `evdash/studies/measures.py`.

A study runs a day many times over: with other random arrivals, settings, policies, network models
or sites of the station. It is a file:

```toml
format = 1
name = "How many chargers?"
base = "summer-weekday"
metrics = ["profit", "acceptance", "least_headroom_kw"]

[seeds]
count = 20

[[axis]]
key = "station.chargers"
values = [6, 9, 12, 15, 18, 24]

[[axis]]
name = "transformer, kVA"
key = "line.633-634.rating_kva"
values = [500, 750]
```

```sh
python -m evdash study my-study.toml --out studies/a
```

runs every combination of the axes' values, here 12, with every seed, on all cores. Examples lie in
`data/studies`: a sweep, a heat map, siting, bands, tariffs and the next upgrade. The whole file is
checked before anything is run, every combination of values too, and all faults are told together.

## What comes of it

`--out DIR` holds

- `runs.csv`: every run with its place on the axes, policy, network model, seed, status (`done`,
  `failed` with its reason, `not run yet`), and the metrics;
- `summary.csv`: for every combination and metric, over its seeds: mean, its standard error, and the
  values below which 5, 50 and 95 % of days lie;
- `differences.csv`: the same of what differs from the first combination (the first value of every
  axis) day by day, on the same seeds, so that the luck of who came does not count. Where only
  policies or network models vary, the first of them is held against instead. Put first what the
  rest is to be measured against: "what is the next upgrade worth" is such a study;
- `study.toml` and `scenario/`, the study and its base scenario, to go on with anywhere;
- `results.sqlite3`, where results land one by one, and `about.json`, the versions.

## Stopped, killed, changed

A result is kept under a digest of its scenario, seed, policy, network model, and of the code and
packages that made it. So the same command goes on with what is left after Ctrl-C, a kill or a
power cut, runs only what is new when the study has more seeds or values, and takes nothing that
other code made. A run that fails is kept with its reason and ends nothing; `--retry` tries failed
ones again. Policies of one's own are given by `--policies` each time, in place of the file's.
Where a worker process dies, the runs it may have been at are done one by one, and the one it
dies of is recorded. The tables are the same to the last digit whatever the number of workers and
the order in which they came: a run has one thread, and the solver's limits are counts of
work, never seconds.

Exit status: 0 done; 1 stopped, or some run failed; 2 wrong input.

## On a cluster

The same runs go to the workers of a [Dask](https://distributed.dask.org) scheduler by naming its
address. Every machine needs this folder, the environment of the README, and
`requirements-cluster.txt`; from the folder of the program start

```sh
# on one machine, HOST being its address on a network that only you reach
python -m distributed.cli.dask_scheduler --host HOST --port 8786 --dashboard-address 127.0.0.1:0
# on every one, with its own address in place of OWN
python -m distributed.cli.dask_worker tcp://HOST:8786 --host OWN --dashboard-address 127.0.0.1:0 \\
    --nworkers auto --nthreads 1
python -m evdash study my-study.toml --out studies/a --scheduler tcp://HOST:8786
```

A worker with other code or packages than the machine that asks is refused. Results land on the
machine that asks, as they do from its own cores.

**Whoever reaches a scheduler or a worker can run any code on its machine.** Dask's connections are
neither encrypted nor authenticated unless it is given certificates (`--tls-ca-file`, `--tls-cert`,
`--tls-key`), and without `--host` it listens on all addresses of the machine; its dashboard does
even then, unless it has an address of its own. On a single machine give `127.0.0.1`.

## In the app

The page **Studies** asks the usual questions of the present run's scenario, or varies what you
choose; of several values each comma is followed by a blank, as `0,3` may be one. A study runs in
a process of its own: it outlives a page change, a reload, and a restart of the server; the
address of the page leads back to it. It makes way for those who step days on the same server: it
runs at low priority on all cores but one, and studies of several people take turns.

## How AC is checked

Every run's executed schedule is solved in full AC by batched power flow; of the runs chosen by lot
(`referee_every`) the voltages are held against pandapower's, in `referee_error_pu`.
"""


def field_rows(record: type[BaseModel]) -> str:
    """A record's fields as a table."""
    lines = ["| key | meaning | unit | allowed | if left out |", "| --- | --- | --- | --- | --- |"]
    for name, field in record.model_fields.items():
        extra = field.json_schema_extra if isinstance(field.json_schema_extra, dict) else {}
        meaning = (field.description or "").replace("|", "\\|")
        unit = extra.get("unit", "")
        lines.append(f"| `{name}` | {meaning} | {unit} | {bounds(field)} | {default(field)} |")
    return "\n".join(lines)


def default(field: FieldInfo) -> str:
    """What a field is where it is left out."""
    if field.is_required():
        return "a fault"
    if field.default in (None, (), {}, ""):
        return "none"
    value = field.default
    return f"`{', '.join(value) if isinstance(value, tuple) else value}`"


def document() -> str:
    """The whole page."""
    parts = [INTRODUCTION, "## The study file\n", field_rows(Study) + "\n"]
    for title, record in (
        ("`[seeds]`", Seeds),
        ("`[[axis]]`", Axis),
        ("`[[axis.case]]`", Case),
    ):
        parts.append(f"### {title}\n\n{field_rows(record)}\n")
    parts.append(
        "## Keys\n\nEvery key of `scenario.toml`, as in `--set` (see "
        "[scenario.md](scenario.md)): `station.chargers`, `option.C1.price_per_kwh`, "
        "`arrivals.vehicles_per_day`, `station.node`. And keys of their own:\n"
    )
    lines = ["| key | meaning | allowed |", "| --- | --- | --- |"]
    lines += [f"| `{key.form}` | {key.meaning} | {key.allowed} |" for key in STUDY_KEYS.values()]
    parts.append("\n".join(lines) + "\n")
    parts.append("## Metrics\n")
    lines = ["| metric | what it is | unit | meaning |", "| --- | --- | --- | --- |"]
    for name, measure in MEASURES.items():
        words = " In `runs.csv` only." if name in TEXTS else ""
        lines.append(f"| `{name}` | {measure.title} | {measure.unit} | {measure.meaning}{words} |")
    parts.append("\n".join(lines) + "\n")
    return "\n".join(parts)


if __name__ == "__main__":
    (HERE / "studies.md").write_text(document(), encoding="utf-8", newline="\n")
