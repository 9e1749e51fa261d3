"""P1 worked by hand where it is easily got wrong."""

import numpy as np
import pytest

from evdash.domain.plan import Plan
from evdash.horizon.advance import snapshot_of
from evdash.horizon.day import run_day, start_day, step
from evdash.scheduling.effort import Effort
from evdash.scheduling.p1 import p1_policy
from evdash.scheduling.problem import Problem, Solution
from evdash.scheduling.reference import solve_reference
from tests.builders import generator, make_scenario, vehicle
from tests.horizon.days import with_headroom

P1 = p1_policy(solve_reference)


def first_plan(**scenario) -> Plan:
    return step(start_day(make_scenario(**scenario)), P1).steps[0].plan


def reasons(plan: Plan) -> dict[str, str]:
    return {refusal.vehicle: str(refusal.reason) for refusal in plan.refused}


def test_without_vehicles_there_is_nothing_to_decide():
    plan = first_plan()
    assert plan.vehicles == ()
    assert plan.power_kw.shape == (0, 4)
    assert (plan.report.status, plan.report.objective, plan.report.bound) == ("optimal", 0.0, 0.0)


def test_a_day_of_one_interval():
    plan = first_plan(price=[0.1], vehicles=[vehicle("v", need_kwh=8.0)])
    assert plan.admitted == ("v",)
    assert plan.power_kw.tolist() == [[8.0]]
    assert plan.report.objective == pytest.approx(8 * 0.1 - 8 * 0.4)


def test_without_chargers_everybody_is_refused_for_it():
    plan = first_plan(vehicles=[vehicle("v")], station={"chargers": 0})
    assert reasons(plan) == {"v": "the station has no chargers"}


def test_without_headroom_everybody_is_refused_for_want_of_room():
    plan = first_plan(**with_headroom([0.0] * 4), vehicles=[vehicle("v")])
    assert plan.admitted == ()
    assert reasons(plan)["v"] == (
        "the feeder by itself leaves too little headroom before its return: rating of node a"
    )


def test_headroom_is_shared_to_the_last_kw():
    # 5 kW in each of two intervals; each vehicle needs 5 kWh within two: both, not three
    room = with_headroom([5.0, 5.0])
    vehicles = [vehicle(f"{n}", need_kwh=5.0, option="C2") for n in range(3)]
    plan = first_plan(**room, price=[0.1, 0.1], vehicles=vehicles)
    assert len(plan.admitted) == 2
    assert plan.station_kw == pytest.approx([5.0, 5.0])


def test_one_charger_goes_to_the_vehicle_that_earns_more():
    vehicles = [vehicle("small", need_kwh=6.0), vehicle("large", need_kwh=8.0)]
    plan = first_plan(price=[0.1, 0.1], vehicles=vehicles, station={"chargers": 1})
    assert plan.admitted == ("large",)


def test_each_option_pays_its_own_price_and_has_its_own_time():
    options = [
        {"name": name, "price_per_kwh": price, "average_kw": average}
        for name, price, average in [("fast", 0.5, 10), ("slow", 0.3, 5), ("idle", 0.2, 2.5)]
    ]
    vehicles = [vehicle(o["name"], need_kwh=10.0, option=o["name"]) for o in options]
    # energy at 0.4 $ at first: only who pays more, or may wait for 0.1 $, is worth having
    plan = first_plan(price=[0.4, 0.4, 0.1, 0.2], vehicles=vehicles, options=options)
    assert plan.admitted == ("fast", "idle")
    assert plan.power_kw.tolist() == [[10, 0, 0, 0], [0, 0, 10, 0]]
    assert reasons(plan) == {
        "slow": "its energy costs no less than it pays: at least $4.00, and it pays $3.00 for "
        "10.0 kWh"
    }


def test_a_vehicle_is_charged_no_faster_than_it_can_take():
    plan = first_plan(price=[-0.1, 0.1, 0.1, 0.1], vehicles=[vehicle("v", max_kw=2.5)])
    assert plan.power_kw.tolist() == [[2.5, 2.5, 2.5, 2.5]]


def test_in_quarter_hours_power_is_four_times_the_energy():
    plan = first_plan(vehicles=[vehicle("v", need_kwh=2.0)], interval_minutes=15)
    assert plan.power_kw.sum() == pytest.approx(8.0)


def test_a_need_below_the_lowest_power_runs_for_part_of_an_interval():
    plan = first_plan(price=[0.1, 0.0], vehicles=[vehicle("v", need_kwh=0.5, option="C2")])
    assert plan.admitted == ("v",)
    assert sorted(plan.power_kw[0]) == [0.0, 0.5]  # whole, never split


def test_a_need_no_number_of_intervals_gives_is_refused_for_that():
    station = {"min_kw": 6.0, "max_kw": 7.0}
    options = [{"name": "C1", "price_per_kwh": 0.4, "average_kw": 3.0}]
    plan = first_plan(vehicles=[vehicle("v")], station=station, options=options)
    assert reasons(plan) == {
        "v": "no whole number of intervals can give what it needs: 10.00 kWh is more "
        "than 1 intervals at 7 kW and less than 2 at 6 kW"
    }


def test_a_vehicle_slower_than_the_charger_can_go_is_refused_for_that():
    plan = first_plan(vehicles=[vehicle("v", max_kw=1.5)])
    assert reasons(plan) == {
        "v": "no whole number of intervals can give what it needs: it takes at most 1.5 kW, a "
        "charger gives at least 2 kW"
    }


def test_a_contract_without_slack_is_charged_in_full_whatever_it_costs():
    # promised at its own full power: 24 kWh in three intervals at 8 kW, even at 0.6 $
    vehicles = [vehicle("v", need_kwh=24.0, max_kw=8.0)]
    plan = first_plan(price=[0.1, 0.6, 0.1, 0.1], vehicles=vehicles)
    assert plan.power_kw.tolist() == [[8.0, 8.0, 8.0, 0.0]]


def test_energy_dearer_than_every_price_means_no_contract():
    plan = first_plan(price=[0.5] * 4, vehicles=[vehicle("v")])
    assert plan.admitted == ()
    assert plan.report.objective == 0.0


def test_a_negative_price_is_sought_and_pays():
    vehicles = [vehicle("v", need_kwh=9.0, option="C2")]
    plan = first_plan(price=[0.1, 0.1, -0.2, 0.1], vehicles=vehicles)
    assert plan.power_kw.tolist() == [[0, 0, 9, 0]]
    assert plan.report.objective == pytest.approx(-0.2 * 9 - 0.3 * 9)


@pytest.mark.parametrize("scale", [1.0, 1e-3])
def test_the_gap_is_absolute_where_the_objective_is_next_to_nothing(scale):
    # worth 1 $ and 2 $ of revenue, or a thousandth: near zero a relative gap proves nothing
    vehicles = [vehicle(f"{n}", need_kwh=need) for n, need in enumerate([2.5, 5.0, 7.5, 5.0])]
    options = [{"name": "C1", "price_per_kwh": 0.1 + 0.01 * scale, "average_kw": 8.0}]
    plan = first_plan(price=[0.1, 0.1], vehicles=vehicles, options=options)
    assert plan.report.status == "optimal"
    assert plan.report.objective - plan.report.bound <= 0.01
    assert plan.report.bound <= plan.report.objective + 1e-9


@pytest.mark.parametrize("need", [3.2999999, 3.3, 3.3000001, 6.6, 6.5999999 + 3.3, 9.9])
def test_what_floating_point_leaves_over_is_never_infeasible(need):
    station = {"min_kw": 3.3, "max_kw": 3.3, "efficiency": 0.9}
    options = [{"name": "C1", "price_per_kwh": 0.4, "average_kw": 3.3}]
    day = make_scenario(
        vehicles=[vehicle("v", need_kwh=need * 0.9)], station=station, options=options
    )
    trace = run_day(start_day(day), P1)
    assert [s.plan.report.status for s in trace.steps] == ["optimal"] * 4
    assert sum(s.station_kw for s in trace.steps) in (0.0, pytest.approx(need, abs=1e-6))


def test_the_tail_of_a_plan_is_feasible_for_the_next_to_the_last_bit():
    # thirds of kWh: owed, delivered and tail never add up exactly in binary
    vehicles = [vehicle(f"{n}", need_kwh=20 / 3 + n / 7, option="C2") for n in range(4)]
    day = make_scenario(**with_headroom([7.1, 8 / 3, 10 / 3, 25.0]), vehicles=vehicles)
    trace = run_day(start_day(day), P1)
    for taken in trace.steps[1:]:
        alone = snapshot_of(taken.inputs, taken.before)
        assert np.allclose(
            [c.owed_kwh for c in alone.contracts], alone.tail_kw.sum(axis=1), atol=1e-9
        )
        assert taken.plan.report.status == "optimal"


def test_an_interval_that_highs_presolve_calls_infeasible_is_solved_all_the_same():
    """Interval 7 of this day: four contracts without slack, whose tail is feasible to the bit."""
    day = make_scenario(price=[0.1] * 12, arrivals=generator(vehicles_per_day=300.0))
    trace = run_day(start_day(day), P1)
    assert [s.plan.report.status for s in trace.steps] == ["optimal"] * 12
    snapshot = snapshot_of(trace.inputs, trace.steps[7].before)
    tail_cost = float(snapshot.price_per_kwh @ snapshot.tail_kw.sum(axis=0))
    assert trace.steps[7].plan.report.objective <= tail_cost + 1e-9


def test_the_tail_is_kept_where_the_solver_has_nothing_cheaper():
    """A solver stopped early may hand over a plan worth less than what remains of the last."""
    scenario = make_scenario(
        price=[0.3, 0.2, 0.1, 0.1], vehicles=[vehicle("v", need_kwh=12.0, option="C2", max_kw=8.0)]
    )
    begun = step(start_day(scenario), P1)
    assert begun.state.contracts

    def dear(problem: Problem, effort: Effort) -> Solution:
        power_kw = np.array([[8.0, 4.0, 0.0]])
        return Solution(np.array([True]), power_kw, bound=-np.inf)

    kept = step(begun, p1_policy(dear)).steps[-1].plan
    snapshot = snapshot_of(begun.inputs, begun.state)
    cost = snapshot.price_per_kwh @ kept.power_kw.sum(axis=0)
    assert cost <= snapshot.price_per_kwh @ snapshot.tail_kw.sum(axis=0) + 1e-9
    assert cost < snapshot.price_per_kwh @ [8.0, 4.0, 0.0]
    assert kept.report.status == "feasible"


@pytest.mark.parametrize("policy", [P1, p1_policy()], ids=["reference", "fast"])
def test_a_tail_a_hair_outside_the_limits_is_still_feasible(policy):
    """3.2999999 kW where a charger holds 3.3, and a hair over the headroom: within the checker's
    tolerance, beyond any solver's."""
    day = make_scenario(
        **with_headroom([25.0, 6.6, 6.6 - 2e-7, 25.0]),
        vehicles=[vehicle(name, need_kwh=9.9, option="slow") for name in ("a", "b")],
        station={"min_kw": 3.3, "max_kw": 3.3},
        options=[{"name": "slow", "price_per_kwh": 0.4, "average_kw": 3.3}],
    )
    begun = step(start_day(day), policy_giving([3.3 + 1e-7, 3.3 - 1e-7, 3.3 - 1e-9]))
    assert begun.steps[0].plan.report.status == "feasible", begun.steps[0].plan.report.note
    trace = run_day(begun, policy)
    assert [s.plan.report.status for s in trace.steps[1:]] == ["optimal"] * 3
    assert not trace.state.contracts


def policy_giving(each: list[float]):
    """Everybody admitted and charged alike."""

    def policy(snapshot):
        names = tuple(r.vehicle for r in snapshot.requests)
        power_kw = np.zeros((len(names), snapshot.n_slots))
        power_kw[:, : len(each)] = each
        return Plan(snapshot.now, names, power_kw, admitted=names)

    return policy
