"""Money is made in one place, energy's in `Tariff`, a driver's in `Request`, and told in one."""

import ast
import re
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from evdash.domain.events import Event
from evdash.domain.scenario import Scenario
from evdash.domain.tariff import Tariff
from evdash.domain.words import money, some_money
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.records import executed_tariff
from evdash.scheduling.p1 import p1_policy
from tests.builders import make_scenario, vehicle

EVDASH = Path(__file__).parents[2] / "evdash"
# Money is made here; the referees below reckon by themselves, or they would be none.
HOMES = ("domain/tariff.py", "domain/vehicles.py")
REFEREES = ("audit/", "checker/")
# Where schedules are chosen by it: as the paper writes P1, fast, of equal worth, and nearest.
PROGRAMS = {
    "scheduling/equations.py",
    "scheduling/fast/relaxation.py",
    "scheduling/earliest.py",
    "scheduling/nearest.py",
}
PRICE, COEFFICIENT = "price_per_kwh", "cost_per_kw"
PRODUCTS = {"dot", "inner", "vdot", "matmul", "multiply", "einsum", "tensordot", "outer"}


def mentions(tree: ast.AST, names: set[str]) -> bool:
    """Whether a price, or something made from one, stands anywhere in an expression."""
    return any(
        (isinstance(node, ast.Attribute) and node.attr == PRICE)
        or (isinstance(node, ast.Name) and node.id in names)
        for node in ast.walk(tree)
    )


def made_from_prices(function: ast.AST) -> set[str]:
    """Names of a function that hold prices, also by way of other names."""
    names, before = {PRICE}, set[str]()
    while names != before:
        before = set(names)
        for node in ast.walk(function):
            if isinstance(node, ast.Assign):
                targets, value = node.targets, node.value
            elif isinstance(node, ast.comprehension | ast.For):
                targets, value = [node.target], node.iter
            else:
                continue
            if mentions(value, names):
                names |= {n.id for t in targets for n in ast.walk(t) if isinstance(n, ast.Name)}
    return names


def is_constant(tree: ast.AST) -> bool:
    """A figure, or a name in capitals: twice a price is a price, and no money yet."""
    return isinstance(tree, ast.Constant) or (isinstance(tree, ast.Name) and tree.id.isupper())


def sums_of_money(source: str) -> Iterator[int]:
    """The lines in which a price is multiplied by something that is no constant."""
    for function in ast.walk(ast.parse(source)):
        if not isinstance(function, ast.FunctionDef | ast.Lambda):
            continue
        names = made_from_prices(function)
        for node in ast.walk(function):
            if isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mult | ast.MatMult):
                sides = (node.left, node.right)
            elif isinstance(node, ast.AugAssign) and isinstance(node.op, ast.Mult | ast.MatMult):
                sides = (node.target, node.value)
            elif isinstance(node, ast.Call) and getattr(node.func, "attr", "") in PRODUCTS:
                sides = (*node.args, node.func)
            else:
                continue
            if any(mentions(side, names) for side in sides) and not any(map(is_constant, sides)):
                yield node.lineno


def sources() -> Iterator[tuple[str, str]]:
    for path in sorted(EVDASH.rglob("*.py")):
        yield path.relative_to(EVDASH).as_posix(), path.read_text(encoding="utf-8")


def test_money_is_made_in_one_place_and_by_the_referees():
    found = {path: lines for path, text in sources() if (lines := sorted({*sums_of_money(text)}))}
    elsewhere = {path: at for path, at in found.items() if not path.startswith((*HOMES, *REFEREES))}
    assert elsewhere == {}
    assert set(HOMES) <= set(found)


def test_only_programs_take_the_coefficients():
    takers = {path for path, text in sources() if f".{COEFFICIENT}" in text}
    assert takers == PROGRAMS


def test_referees_know_no_sum_of_the_tariffs():
    for path, text in sources():
        if path.startswith(REFEREES):
            nodes = ast.walk(ast.parse(text))
            called = {node.attr for node in nodes if isinstance(node, ast.Attribute)}
            assert called.isdisjoint({"tariff", "cost", COEFFICIENT, "pays"}), path


@pytest.mark.parametrize(
    "body",
    [
        "return s.price_per_kwh @ kw",
        "return kw * hours * s.price_per_kwh[t]",
        "prices = s.price_per_kwh; own = prices[t]; return kw * own",
        "return np.dot(kw, price_per_kwh)",
        "return need_kwh * r.price_per_kwh",
        "cost = hours; cost *= s.price_per_kwh; return cost",
        "return sum(p * k for p, k in zip(s.price_per_kwh, kw))",
    ],
)
def test_these_tests_can_fail(body):
    assert list(sums_of_money(f"def f():\n    {body}"))
    assert not list(sums_of_money("def f():\n    return 2 * s.price_per_kwh, MOST * price_per_kwh"))


def test_a_schedule_costs_what_its_energy_does():
    tariff = Tariff(np.array([0.2, -0.1, 0.4]), 0.5)
    power_kw = np.array([[4.0, 0.0, 2.0], [0.0, 10.0, 0.0]])
    assert tariff.cost(power_kw) == pytest.approx(0.4 - 0.5 + 0.4)
    assert tariff.cost(power_kw[1]) == pytest.approx(-0.5)
    assert tariff.cost(np.zeros((0, 3))) == 0.0
    assert tariff.cost_per_kw @ power_kw.sum(axis=0) == pytest.approx(tariff.cost(power_kw))
    assert tariff.mean_price(power_kw[0]) == pytest.approx(0.8 / 3.0)


def test_what_can_be_said_of_every_schedule():
    tariff = Tariff(np.array([0.2, -0.1, 0.4]), 0.5)
    assert tariff.least_cost(np.array([8.0, 3.0])) == pytest.approx(-0.4 + 0.3)
    assert tariff.most_saved_per_kwh == pytest.approx(0.5)
    dearest, cheapest = 6.0 * 0.4, 6.0 * -0.1
    assert dearest - cheapest < tariff.most_apart(6.0) == pytest.approx(4.8)
    paid_for_drawing = Tariff(np.array([-0.3, 0.1]), 0.5)
    assert paid_for_drawing.most_apart(6.0) == pytest.approx(3.6)


def test_parts_of_a_tariff_are_tariffs():
    tariff = Tariff(np.array([0.2, -0.1, 0.4]), 0.5)
    assert tariff[1:].is_same(Tariff(np.array([-0.1, 0.4]), 0.5))
    assert tariff[np.array([2, 2])].price_per_kwh.tolist() == [0.4, 0.4]
    assert tariff.dearer_by(np.array([0.1, 0.0, 0.0]))[:1].price_per_kwh == pytest.approx([0.3])
    assert not tariff.is_same(Tariff(tariff.price_per_kwh, 1.0))
    assert not tariff.is_same(tariff.dearer_by(np.array([0.0, 0.0, 1e-12])))


def test_a_driver_pays_for_energy_at_the_price_of_the_option():
    asked = start_day(make_scenario(vehicles=[vehicle("a", need_kwh=20.0)])).inputs.requests[0][0]
    assert asked.pays(5.0) == pytest.approx(2.0)
    assert asked.revenue == asked.pays(asked.need_kwh) == pytest.approx(8.0)
    assert asked.with_bonus(3.0).revenue == pytest.approx(11.0)
    assert asked.paying_more(0.1).pays(5.0) == pytest.approx(2.5)


def test_amounts_have_two_digits_and_one_sign():
    told = [money(usd) for usd in (1234.5, -0.35, -0.004, 0.0)]
    assert told == ["$1,234.50", "−$0.35", "$0.00", "$0.00"]
    told = [some_money(usd) for usd in (0.0, 0.004, 0.006, -1.2)]
    assert told == ["$0.00", "less than a cent", "$0.01", "−$1.20"]


def test_amounts_are_put_in_words_in_one_place():
    amount = re.compile(r"\$\{[^{}]*\.2f\}")
    assert {path for path, text in sources() if amount.search(text)} == {"domain/words.py"}


@dataclass(frozen=True, slots=True)
class Taxed(Tariff):
    """With a component that the tariff of today has not."""

    tax_per_kwh: float = 0.2


def test_no_part_of_a_tariff_loses_a_component():
    """Parts rebuilt by position lost it in silence: the tax was planned with and never paid."""
    taxed = Taxed(np.array([0.1, 0.2, 0.3]), 1.0)
    for part in (
        taxed[1:],
        taxed[np.array([2, 0])],
        taxed.dearer_by(np.ones(3)),
        taxed.followed_by([]),
    ):
        assert isinstance(part, Taxed)
        assert part.tax_per_kwh == 0.2
    assert not taxed.is_same(replace(taxed, tax_per_kwh=0.3))


def test_what_was_executed_is_the_tariff_in_force_interval_by_interval(monkeypatch):
    trace = start_day(make_scenario(price=(0.1, 0.2, 0.4), vehicles=[vehicle("a")]))
    trace = step(trace, p1_policy())
    trace = happen(trace, [Event(interval=1, event="price", value=0.7)])
    trace = run_day(trace, p1_policy())
    assert executed_tariff(trace).price_per_kwh.tolist() == [0.1, 0.7, 0.7]
    monkeypatch.setattr(
        Scenario, "tariff", property(lambda s: Taxed(s.price_per_kwh, s.interval_hours))
    )
    assert isinstance(executed_tariff(trace), Taxed)
