"""The paper's scalability study: the bundled day with 100 random arrivals, each solved whole.

    python -m benchmarks.paper_days            # prints, and writes data/results/paper_days.json

Times are of solving alone, summed over the intervals of a day, as the paper's seem to be. Run it
on a machine that does nothing else.
"""

import argparse
import statistics
from pathlib import Path

from evdash.files.bundled import DEFAULT
from evdash.files.scenario_folder import read_scenario
from evdash.scheduling.p1 import p1_policy
from evdash.studies.days import days_taken
from evdash.studies.days_file import PAPER_DAYS, days_text, measured


def main() -> None:
    """Run the days, print their times and write the file."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--days", type=int, default=100)
    parser.add_argument("--out", type=Path, default=PAPER_DAYS)
    parser.add_argument("--note", default="", help="what else may have borne on the times")
    asked = parser.parse_args()
    scenario = read_scenario(DEFAULT)
    days = []
    for day in days_taken(scenario, range(1, asked.days + 1), p1_policy()):
        days.append(day)
        print(f"seed {day.seed:3d}: {day.admitted} of {day.arrived} in {day.seconds:.3f} s")
    seconds = [day.seconds for day in days]
    print(
        f"{len(days)} days: {min(seconds):.2f} to {max(seconds):.2f} s, "
        f"median {statistics.median(seconds):.2f} s"
    )
    asked.out.parent.mkdir(parents=True, exist_ok=True)
    text = days_text(measured(scenario, days, "python -m benchmarks.paper_days", asked.note))
    asked.out.write_text(text, encoding="utf-8", newline="\n")


if __name__ == "__main__":
    main()
