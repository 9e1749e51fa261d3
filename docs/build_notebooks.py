"""Runs the notebooks in `docs/notebooks` anew, in place: `python docs/build_notebooks.py [NAME …]`.

A test runs them, too, and holds what they print to what stands in them.
"""

import os
import sys
from pathlib import Path

import nbformat
from nbclient import NotebookClient
from nbformat import NotebookNode

HERE = Path(__file__).parent
NOTEBOOKS = HERE / "notebooks"
FIGURE = "application/vnd.plotly.v1+json"


def executed(path: Path) -> NotebookNode:
    """A notebook with what its cells give now; raises nbclient's CellExecutionError."""
    book = nbformat.read(path, as_version=4)
    for cell in book.cells:
        if cell.cell_type == "code":
            cell.outputs, cell.execution_count = [], None
    # figures as data alone, without a script from anywhere
    environment = os.environ | {
        "PLOTLY_RENDERER": "plotly_mimetype",
        "PYTHONPATH": str(HERE.parent),
    }
    client = NotebookClient(book, timeout=None, kernel_name="python3", record_timing=False)
    client.execute(cwd=str(NOTEBOOKS), env=environment)
    book.metadata["language_info"] = {"name": "python"}
    for data in results(book):
        data.get(FIGURE, {}).pop("config", None)  # names a server of Plotly's that nobody asks
    return book


def results(book: NotebookNode) -> list[NotebookNode]:
    """What cells show, by kind."""
    outputs = (output for cell in book.cells for output in cell.get("outputs", ()))
    return [output.data for output in outputs if "data" in output]


def printed(book: NotebookNode) -> list[str]:
    """What cells print and show, as text; figures by their kinds of trace."""
    told = []
    for output in (output for cell in book.cells for output in cell.get("outputs", ())):
        data = output.get("data", {})
        drawn = [trace["type"] for trace in data.get(FIGURE, {}).get("data", ())]
        told.append(output.get("text") or data.get("text/plain") or f"{drawn}")
    return told


if __name__ == "__main__":
    for path in sorted(NOTEBOOKS.glob("*.ipynb")):
        if not sys.argv[1:] or path.stem in sys.argv[1:]:
            nbformat.write(executed(path), path)
