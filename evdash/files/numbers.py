"""Numbers as people type them: read as they stand or refused in words, never reinterpreted.

The decimal sign is a point, as in every file of a scenario. A comma is refused, with what may have
been meant: `1,234` is 1234 to some and 1.234 to others.
"""

import re

NUMBER = "should be a number"
WHOLE = "should be a whole number"
FINITE = "should be a finite number"
MINUS = "\N{MINUS SIGN}"
_PLAIN = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?", re.ASCII | re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d+", re.ASCII)
_DECIMAL_COMMA = re.compile(r"([+-]?\d*),(\d+)", re.ASCII)
_THOUSANDS = re.compile(r"[+-]?[1-9]\d{0,2}(,\d{3})+(\.\d*)?", re.ASCII)
_POINTED = re.compile(r"([+-]?[1-9]\d{0,2}(?:\.\d{3})+),(\d+)", re.ASCII)
_THEN_A_UNIT = re.compile(rf"({_PLAIN.pattern})\s*[^\d\s.,'_][^\d]*", re.ASCII | re.IGNORECASE)
LONGEST = 60


def read_number(text: str, *, whole: bool = False) -> int | float:
    """The number a text stands for; ValueError says what would have been right."""
    typed = text.strip().replace(MINUS, "-")
    if _WHOLE.fullmatch(typed) and len(typed) <= LONGEST:
        return int(typed) if whole else float(typed)
    if whole or not _PLAIN.fullmatch(typed):
        raise ValueError(number_rule(text, whole=whole))
    number = float(typed)
    if abs(number) == float("inf"):
        raise ValueError(FINITE)
    return number


def number_rule(text: str, *, whole: bool = False) -> str:
    """What would have been right in place of a text that was not read as a number."""
    typed = text.strip().replace(MINUS, "-")
    kind = WHOLE if whole else NUMBER
    if len(typed) > LONGEST:
        return kind
    meant = _meant(typed)
    if whole:
        meant = [one for one in meant if _WHOLE.fullmatch(one)]
    if "," in typed and meant:
        how = "without commas" if whole else "with a point and no commas"
        return f"{kind}, {how}: {' or '.join(meant)}"
    if meant and not _PLAIN.fullmatch(typed):
        return f"{kind} and nothing else: {meant[0]}"
    return kind


def _meant(typed: str) -> list[str]:
    """What a text that is no number may have meant, as it should have been written."""
    meant = []
    if _THOUSANDS.fullmatch(typed):
        meant.append(typed.replace(",", ""))
    if pointed := _POINTED.fullmatch(typed):
        meant.append(f"{pointed[1].replace('.', '')}.{pointed[2]}")
    if decimal := _DECIMAL_COMMA.fullmatch(typed):
        whole = decimal[1] if decimal[1] not in ("", "+", "-") else f"{decimal[1]}0"
        meant.append(f"{whole}.{decimal[2]}")
    joined = "".join(typed.split())
    if joined != typed and _PLAIN.fullmatch(joined):
        meant.append(joined)
    elif measured := _THEN_A_UNIT.fullmatch(typed):
        meant.append(measured[1])
    return meant


def number_text(value: float) -> str:
    """A number as a person would type it; `read_number` gives back the very same one."""
    return str(value) if isinstance(value, int) else repr(float(value)).removesuffix(".0")
