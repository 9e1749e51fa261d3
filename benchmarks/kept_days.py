"""Long runs over seeds that can be stopped and taken up again: days are kept as they are done."""

from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor, as_completed
from pathlib import Path
from typing import Protocol, TypeVar

from pydantic import TypeAdapter
from rich.console import Console
from rich.progress import track


class Seeded(Protocol):
    """What came of the day of a seed."""

    @property
    def seed(self) -> int:
        """Which day."""
        ...


R = TypeVar("R", bound=Seeded)


def run_kept(
    run_one: Callable[[int], R],
    seeds: range,
    workers: int,
    form: TypeAdapter[R],
    *,
    told: str,
    file: Path | None,
) -> list[R]:
    """What came of every seed's day, in their order; days in the file are not run again.

    A day is a line of JSON, appended as soon as it is done.
    """
    known = {result.seed: result for result in kept(file, form)}
    results = [known[seed] for seed in seeds if seed in known]
    with ProcessPoolExecutor(workers) as pool:
        running = [pool.submit(run_one, seed) for seed in seeds if seed not in known]
        console = Console(stderr=True)
        for future in track(as_completed(running), told, total=len(running), console=console):
            results.append(future.result())
            if file is not None:
                with file.open("ab") as lines:
                    lines.write(form.dump_json(results[-1]) + b"\n")
    return sorted(results, key=lambda result: result.seed)


def kept(file: Path | None, form: TypeAdapter[R]) -> list[R]:
    """The days of an earlier run; none where there is no file."""
    if file is None or not file.exists():
        return []
    return [form.validate_json(line) for line in file.read_bytes().splitlines()]
