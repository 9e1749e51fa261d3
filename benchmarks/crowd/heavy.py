"""People who ask for a lot at once: a day of 5,000 vehicles, a study of many hundred days."""

import asyncio
import time
from collections.abc import Coroutine
from typing import Any

from benchmarks.crowd.days import day_of, kept_in
from benchmarks.crowd.server import Server
from benchmarks.crowd.visitor import Visitor

MANY_VEHICLES = 5_000.0
NUMBER = 9_000


def heavy_users(server: Server, end: float) -> list[Coroutine[Any, Any, None]]:
    """Both of them, until `end`."""
    link = kept_in(server.store, day_of(NUMBER, MANY_VEHICLES))
    return [_keep_asking(server, f"run={link}", "live", "finish", end), _study(server, end)]


async def _keep_asking(server: Server, query: str, page: str, button: str, end: float) -> None:
    """Press a button of a page and wait for whatever comes, however long that takes."""
    visitor = Visitor(server.address)
    await visitor.open(query)
    if page != "live":
        await visitor.turn_to(page)
    await visitor.press(button, wait=False)
    await asyncio.sleep(max(0.0, end - time.monotonic()))
    await visitor.close()


async def _study(server: Server, end: float) -> None:
    """The first question of the Studies page, as it stands there."""
    await _keep_asking(server, "", "studies", "start_study", end)
