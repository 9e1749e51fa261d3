"""Writes the table of what the audit works out into `docs/reliability.md`, from its declaration.

Run `python docs/build_audit_table.py` after changing `evdash/audit/coverage.py`; a test holds both
in step.
"""

import sys
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from evdash.audit.coverage import coverage_table  # noqa: E402 - the path above makes it so

PAGE = HERE / "reliability.md"
BEGIN, END = "<!-- from evdash/audit/coverage.py -->\n", "<!-- to here -->\n"


def page(text: str) -> str:
    """The page with the table as declared."""
    before, _, rest = text.partition(BEGIN)
    _, _, after = rest.partition(END)
    table = "\n".join(coverage_table())
    return f"{before}{BEGIN}\n{table}\n\n{END}{after}"


if __name__ == "__main__":
    PAGE.write_text(page(PAGE.read_text(encoding="utf-8")), encoding="utf-8", newline="\n")
