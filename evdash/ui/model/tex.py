"""Numbers and names as KaTeX shows them."""

from collections.abc import Sequence

from evdash.domain.words import money

MOST_TERMS = 4
"""Of as many as fit a card on a laptop, three columns beside each other."""


def number(value: float, digits: int = 1) -> str:
    """A number with thin spaces between thousands and a true minus."""
    return f"{value:,.{digits}f}".replace(",", r"\,")


def signed(value: float, digits: int = 1) -> str:
    """A number as a further term of a sum, with its sign."""
    return f"{'-' if value < 0 else '+'} {number(abs(value), digits)}"


def name(text: str) -> str:
    """User text in upright letters; whatever could be a command is written by its code."""
    return r"\text{" + "".join(c if c.isalnum() else f'\\char"{ord(c):X} ' for c in text) + "}"


def total(terms: Sequence[float], digits: int = 1) -> str:
    """A sum written out, shortened in the middle where it is long; 0 where it is empty."""
    shown = [number(term, digits) for term in terms]
    if len(shown) > MOST_TERMS:
        shown = [*shown[: MOST_TERMS - 2], r"\cdots", shown[-1]]
    return " + ".join(shown) or "0"


def lines(*formulas: str) -> str:
    """Formulas one below the other, where beside each other they would be cut off."""
    return r"\begin{gathered}" + r"\\".join(formulas) + r"\end{gathered}"


def usd(value: float) -> str:
    """An amount of money."""
    return money(value).replace("−", "-").replace("$", r"\$").replace(",", r"\,")
