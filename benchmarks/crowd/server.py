"""A real server in a process of its own, on this machine only, and what it takes."""

import os
import re
import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from evdash.store.place import VARIABLE

ROOT = Path(__file__).parents[2]
PATIENCE_SECONDS = 120.0


@dataclass(frozen=True, slots=True)
class Server:
    """Where a server listens, and its process."""

    address: str
    store: Path
    process: subprocess.Popen[bytes]

    @property
    def memory_mb(self) -> float:
        """Resident memory now."""
        status = Path(f"/proc/{self.process.pid}/status").read_text(encoding="ascii")
        found = re.search(r"VmRSS:\s+(\d+) kB", status)
        return int(found[1]) / 1024 if found else float("nan")

    @property
    def cpu_seconds(self) -> float:
        """Processor time taken so far."""
        fields = Path(f"/proc/{self.process.pid}/stat").read_text(encoding="ascii").split(")")[1]
        user, system = fields.split()[11:13]
        return (int(user) + int(system)) / os.sysconf("SC_CLK_TCK")


@contextmanager
def serving(
    store: Path, *options: str, log: int = subprocess.DEVNULL, app: Path = ROOT / "app.py"
) -> Iterator[Server]:
    """A fresh server that keeps runs in `store`; ended afterwards."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    address = f"http://127.0.0.1:{port}"
    command = [sys.executable, "-m", "streamlit", "run", str(app)]
    flags = ["--server.headless=true", f"--server.port={port}", "--server.address=127.0.0.1"]
    process = subprocess.Popen(
        [*command, *flags, *options],
        cwd=ROOT,
        stdout=log,
        stderr=log,
        env=os.environ | {VARIABLE: str(store)},
    )
    try:
        _wait_until_healthy(process, address)
        yield Server(address, store, process)
    finally:
        process.terminate()
        try:
            process.wait(20)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()


def ask(address: str, timeout_seconds: float = 5.0) -> bytes:
    """What a server of this machine answers; raises OSError where it does not, or with a fault.

    No proxy is asked, whatever the environment says, or said when the first page was fetched.
    """
    opener = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with opener.open(address, timeout=timeout_seconds) as answer:
        found: bytes = answer.read()
        return found


def _wait_until_healthy(process: subprocess.Popen[bytes], address: str) -> None:
    until = time.monotonic() + PATIENCE_SECONDS
    while time.monotonic() < until:
        if process.poll() is not None:
            raise RuntimeError("the server ended before it was healthy")
        try:
            if ask(f"{address}/_stcore/health"):
                return
        except OSError:
            time.sleep(0.2)
    raise RuntimeError("the server did not become healthy in time")
