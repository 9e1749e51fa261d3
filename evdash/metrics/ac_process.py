"""The AC check in a process of its own: a power flow would hold up every page of the server.

`python -m evdash.metrics.ac_process` answers each line it is given by a line, both JSON, until
nobody is there to give one any more. It also spares the server pandapower's memory.
"""

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Mapping
from typing import IO, Any

import numpy as np
from pydantic import TypeAdapter

from evdash.domain.breach import Breach
from evdash.domain.scenario import Scenario
from evdash.errors import EvdashError
from evdash.metrics.ac import AcPoint
from evdash.metrics.ac_kept import KeptFlows
from evdash.resources import IMPORTABLE_FROM

PATIENCE_SECONDS = 120.0
"""For one answer, the seconds that loading pandapower takes before the first included."""


class ProcessEnded(EvdashError):
    """The process of the AC power flow ended without an answer."""


class AcProcess:
    """`KeptFlows` in a process that begins with the first question, for one thread at a time.

    It ends with the server, however that ends. Raises ProcessEnded where it ended by itself, or was
    ended because an answer took longer than `patience_seconds`; the next question begins a new one.
    """

    def __init__(self, patience_seconds: float = PATIENCE_SECONDS) -> None:
        self._patience_seconds = patience_seconds
        self._process: subprocess.Popen[bytes] | None = None

    @property
    def pid(self) -> int | None:
        """The id of the process, if one was begun."""
        return None if self._process is None else self._process.pid

    def point(self, scenario: Scenario, interval: int, station_kw: float) -> AcPoint:
        """As `KeptFlows.point`."""
        return _point_of(self._answer(_question(scenario, interval, station_kw)))

    def prepare(self, scenario: Scenario, interval: int) -> None:
        """As `KeptFlows.prepare`."""
        self._answer(_question(scenario, interval, None))

    def _answer(self, question: Mapping[str, object]) -> dict[str, Any]:
        if self._process is None:
            self._process = subprocess.Popen(
                [sys.executable, "-m", "evdash.metrics.ac_process"],
                cwd=IMPORTABLE_FROM,
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
            )
        process, gave_up = self._process, threading.Event()

        def give_up() -> None:
            gave_up.set()
            process.kill()

        patience = threading.Timer(self._patience_seconds, give_up)
        patience.daemon = True
        patience.start()
        line = _asked(process, json.dumps(question))
        patience.cancel()
        if not line:
            self._process = None
            process.kill()
            status = process.wait()
            if gave_up.is_set():
                raise ProcessEnded(f"no AC power flow within {self._patience_seconds:g} s")
            raise ProcessEnded(f"the process of the AC power flow ended ({status})")
        answer: dict[str, Any] = json.loads(line)
        return answer


def _asked(process: subprocess.Popen[bytes], question: str) -> bytes:
    """The line that answers a question; empty if the process ended before it did."""
    if process.stdin is None or process.stdout is None:
        return b""
    try:
        process.stdin.write(f"{question}\n".encode())
        process.stdin.flush()
        return process.stdout.readline()
    except OSError:
        return b""


def _question(scenario: Scenario, interval: int, station_kw: float | None) -> dict[str, object]:
    """`station_kw`: None where the interval is only to be made ready."""
    told = scenario.model_dump_json()
    return {"scenario": told, "interval": interval, "station_kw": station_kw}


def _told(point: AcPoint) -> dict[str, object]:
    return {
        "voltage_pu": point.voltage_pu.tolist(),
        "line_kva": point.line_kva.tolist(),
        "breaches": BREACHES.dump_python(point.breaches, mode="json"),
        "failure": point.failure,
    }


BREACHES = TypeAdapter(tuple[Breach, ...])


def _point_of(told: Mapping[str, Any]) -> AcPoint:
    breaches = BREACHES.validate_python(told["breaches"])
    voltage_pu, line_kva = (np.array(told[key], dtype=float) for key in ("voltage_pu", "line_kva"))
    return AcPoint(voltage_pu, line_kva, breaches, told["failure"])


def answer_all(questions: IO[bytes], answers: IO[bytes]) -> None:
    """Answer question after question until there are no more."""
    flows = KeptFlows()
    for line in questions:
        question = json.loads(line)
        scenario = Scenario.model_validate_json(question["scenario"])
        interval, station_kw = question["interval"], question["station_kw"]
        answer: dict[str, object] = {}
        if station_kw is None:
            flows.prepare(scenario, interval)
        else:
            answer = _told(flows.point(scenario, interval, station_kw))
        answers.write(f"{json.dumps(answer)}\n".encode())
        answers.flush()


if __name__ == "__main__":
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl+C is the server's affair
    lines, sys.stdout = sys.stdout.buffer, sys.stderr  # what libraries print is no answer
    answer_all(sys.stdin.buffer, lines)
