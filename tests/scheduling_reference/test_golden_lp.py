"""Each equation as LP text, against a file a person can check with the paper in hand.

To write the files anew: python -m tests.scheduling_reference.test_golden_lp
"""

import inspect
from pathlib import Path

import numpy as np
import pytest

from evdash.domain.limits import LimitRows
from evdash.domain.tariff import Tariff
from evdash.scheduling import equations
from evdash.scheduling.equations import Equation, build
from evdash.scheduling.problem import Problem

GOLDEN = Path(__file__).parent / "golden"
BUILT_ON: dict[str, tuple[Equation, ...]] = dict.fromkeys(
    ("least_missing_energy", "fewest_vehicles_short", "least_given_up", "least_money"),
    (equations.energy_owed_or_short,),
)
"""Equations that need what another one brings with it."""

PROBLEM = Problem(
    vehicles=("contracted", "new"),
    n_contracts=1,
    owed_kwh=np.array([6.0, 9.0]),
    intervals_left=np.array([1, 2]),
    low_kw=np.array([3.0, 3.5]),
    high_kw=np.array([12.0, 7.0]),
    revenue=np.array([0.0, 3.6]),
    tariff=Tariff(np.array([0.25, -0.5]), 0.5),
    chargers=1,
    rows=LimitRows(("line:s-a",), np.array([[2.0]]), np.array([[15.0], [20.0]])),
    tail_kw=np.array([[12.0, 0.0], [0.0, 0.0]]),
)
"""One contract, one newcomer, two half-hours: small enough to write out by hand."""


def equations_written() -> dict[str, Equation]:
    """Every equation function of the module, by name."""
    return {
        name: function
        for name, function in inspect.getmembers(equations, inspect.isfunction)
        if function.__module__ == equations.__name__
        and list(inspect.get_annotations(function, eval_str=True).values())
        == [equations.Model, None]
    }


def lp_text(name: str, path: Path) -> str:
    """The equation's LP text, its objective empty unless it brings one."""
    equation = equations_written()[name]
    model = build(PROBLEM, (*BUILT_ON.get(name, ()), equation), name)
    if model.lp.objective is None:
        model.lp += 0
    model.lp.writeLP(str(path / f"{name}.lp"))
    return (path / f"{name}.lp").read_text()


def test_the_module_holds_the_equations_of_p1():
    written = equations_written().values()
    for equation in (*equations.P1, *equations.RECOURSE, *equations.RECOURSE_OBJECTIVES):
        assert equation in written


@pytest.mark.parametrize("name", sorted(equations_written()))
def test_equation_reads_as_its_golden_file(name, tmp_path):
    golden = GOLDEN / f"{name}.lp"
    assert golden.exists(), f"{name} has no golden LP file"
    assert lp_text(name, tmp_path) == golden.read_text()


def test_every_golden_file_belongs_to_an_equation():
    assert {path.stem for path in GOLDEN.glob("*.lp")} == set(equations_written())


def test_every_equation_names_its_number_or_its_part():
    for name, equation in equations_written().items():
        told = inspect.getdoc(equation) or ""
        assert told.startswith(("(", "Objective")), name


if __name__ == "__main__":
    for each in equations_written():
        lp_text(each, GOLDEN)
