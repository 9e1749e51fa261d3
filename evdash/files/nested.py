"""JSON and TOML read as plain data, after a look at how deep they are nested.

Readers call themselves for each level: a file of brackets alone exhausts them, and a key of a
thousand dots takes minutes. Nothing this program reads has more than a few levels.
"""

import json
import re
import tomllib
from typing import Any

MOST_LEVELS = 30
JSON_TEXT = re.compile(r'"(?:[^"\\]|\\.)*+"', re.DOTALL)
TOML_TEXT = re.compile(
    r'"""(?:[^\\]|\\.)*?"""'
    r"|'''.*?'''"
    r'|"(?:[^"\\\n]|\\.)*+"'
    r"|'[^'\n]*+'"
    r"|\#[^\n]*+",
    re.DOTALL,
)
BRACKET = re.compile(r"[\[\]{}]")
DOTTED = re.compile(rf"(?<![\w.-])[\w-]++(?:[ \t]*+\.[ \t]*+[\w-]++){{{MOST_LEVELS},}}")


class TooDeep(ValueError):
    """Text nested deeper than anything that means something here."""

    def __init__(self) -> None:
        super().__init__(f"nested more than {MOST_LEVELS} levels deep")


def read_json(text: str) -> Any:
    """JSON as plain data; raises ValueError where it is none or nested too deep."""
    _refuse_deep(JSON_TEXT.sub("", text))
    return json.loads(text)


def read_toml(text: str) -> dict[str, Any]:
    """TOML as plain data; raises ValueError where it is none or nested too deep."""
    bare = TOML_TEXT.sub("s", text)
    _refuse_deep(bare)
    if DOTTED.search(bare):
        raise TooDeep
    return tomllib.loads(text)


def _refuse_deep(bare: str) -> None:
    """Raise TooDeep; `bare` is text without what stands in quotes."""
    level = 0
    for bracket in BRACKET.finditer(bare):
        level += 1 if bracket.group() in "[{" else -1
        if level > MOST_LEVELS:
            raise TooDeep
