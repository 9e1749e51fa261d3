r"""The one way to the terminal: names appear there as written, never as markup or commands.

Every text is printed without rich's markup and emoji codes, and what no screen shows, such as the
escape character or a mark that turns the direction of writing, is written as `\x1b`, `\u202e`.
"""

import argparse
import codecs
import sys
from typing import Any, NoReturn

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from rich.text import Text

from evdash.errors import Fault, InputError, printable

Part = str | tuple[str, str]
"""A piece of a line, as it is or with its style."""


def line(*parts: Part) -> Text:
    """The parts one after the other, each in its style."""
    whole = Text()
    for part in parts:
        told, style = (part, "") if isinstance(part, str) else part
        whole.append(printable(told), style)
    return whole


class Terminal(Console):
    """Standard output or error. Strings in tables, too, are shown as written."""

    def __init__(self, *, stderr: bool = False) -> None:
        super().__init__(stderr=stderr, highlight=False, markup=False, emoji=False)

    def say(self, *parts: Part) -> None:
        """Print a line, left for the terminal to wrap."""
        self.print(line(*parts), soft_wrap=True)

    def render_str(self, text: str, **how: Any) -> Text:
        return super().render_str(printable(text), **how)


def progress_bar() -> Progress:
    """A bar with a count and the time left, on standard error and gone when the work is done."""
    columns = (
        TextColumn("{task.description}", markup=False),
        BarColumn(),
        MofNCompleteColumn(),
        TimeRemainingColumn(),
    )
    return Progress(*columns, console=Terminal(stderr=True), transient=True)


class Parser(argparse.ArgumentParser):
    """A command line whose complaints, too, show what was typed as it is."""

    def error(self, message: str) -> NoReturn:
        super().error(printable(message))


def check_output() -> None:
    """Raise InputError where standard output cannot hold every name, before any work is done."""
    encoding = getattr(sys.stdout, "encoding", None) or "utf-8"
    if not codecs.lookup(encoding).name.startswith("utf"):
        allowed = "should be UTF-8, in which every name can be written: set PYTHONIOENCODING=utf-8"
        raise InputError([Fault("standard output", f"the encoding {encoding}", allowed)])
