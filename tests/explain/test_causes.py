"""Each cause in a day small enough to know it by construction, and its remedies by arithmetic."""

import pytest

from evdash.domain.elements import Element
from evdash.domain.refusal import CLAUSES
from evdash.errors import SolverFailure
from evdash.explain.refusals import explain_vehicle
from evdash.horizon.day import run_day, start_day
from evdash.policies.rules import by as by_rule
from evdash.policies.rules import first_come
from tests.builders import line, make_scenario, node, vehicle
from tests.explain.cases import by, explained, helpless, roomy

C2 = {"option": "C2"}


def test_headroom_set_by_a_rating():
    """One slot, 10 kWh asked: 7 kW are left in it, 3 are missing."""
    told = explained(roomy([7.0, 30.0], vehicles=[vehicle("v", need_kwh=8.0)]))
    assert told.cause.kind == "feeder"
    assert told.cause.taken.headroom == ((0, Element("node", "a")),)
    assert by(told) == {"headroom": 1.0, "time": 1.0}
    assert helpless(told) == {"chargers", "price"}
    assert told.text == (
        "Refused because the feeder by itself leaves too little headroom before its return: from "
        "00:00 to 01:00 the rating of node a (40 kVA) leaves too little room. It would have been "
        "admitted with 1.0 kW more headroom from 00:00 to 01:00 or with a return 1 h later, at "
        "02:00; more chargers or a higher price alone would not have helped."
    )


def test_headroom_set_by_the_transformer():
    scenario = make_scenario(
        nodes=(node("s"), node("m"), node("a", load_kw=33.0, load_kvar=0.0)),
        lines=(line("s", "m", 0.01, 0.01), line("m", "a", 0.01, 0.01, rating=40.0)),
        price=[0.1] * 3,
        vehicles=[vehicle("v", need_kwh=8.0)],
    )
    told = explained(scenario)
    assert told.cause.kind == "feeder"
    assert told.cause.taken.headroom == ((0, Element("line", "m", "a")),)
    assert "line or transformer m–a (40 kVA)" in told.detail
    assert by(told)["headroom"] == 1.0


def test_headroom_set_by_a_voltage():
    scenario = make_scenario(
        nodes=(node("s"), node("a"), node("b", load_kw=40.0, load_kvar=0.0)),
        lines=(line("s", "a", 1.0, 0.1), line("a", "b", 1.0, 0.1)),
        feeder={"voltage_min_pu": 0.995, "base_kv": 4.16},
        price=[0.1] * 3,
        vehicles=[vehicle("v", need_kwh=8.0)],
    )
    told = explained(scenario)
    assert told.cause.kind == "feeder"
    assert told.cause.taken.headroom == ((0, Element("voltage_min", "b")),)
    assert "the lowest voltage allowed at node b (0.995 pu)" in told.detail


def test_headroom_beside_contracts():
    """c holds 6 of the 10 kW of slots 0 and 1; v comes at 01:00 and needs 8 within an hour."""
    scenario = roomy(
        [10.0, 10.0, 30.0],
        vehicles=[
            vehicle("c", hour=0, need_kwh=20.0, option="C1"),
            vehicle("v", hour=1, need_kwh=8.0),
        ],
        station={"max_kw": 20.0},
        options=({"name": "C1", "price_per_kwh": 0.4, "average_kw": 10.0},),
    )
    told = explained(scenario)
    assert told.cause.kind == "headroom"
    assert "beside the 1 contract already made" in told.detail
    assert by(told)["headroom"] == 8.0


def test_chargers():
    """One charger, in use for a contract without slack."""
    scenario = roomy(
        [50.0] * 3,
        vehicles=[vehicle("c", hour=0, need_kwh=16.0), vehicle("v", hour=1, need_kwh=8.0)],
        station={"chargers": 1, "max_kw": 8.0},
    )
    told = explained(scenario)
    assert told.cause.kind == "chargers"
    assert told.cause.taken.chargers == (1,)
    assert by(told) == {"chargers": 1, "time": 1}
    assert helpless(told) == {"headroom", "price"}
    assert "the only charger is needed by the 1 contract already made" in told.detail


def test_two_more_chargers():
    """Two contracts on two chargers, min power 2; c and v compete for the third: 2 are needed."""
    scenario = roomy(
        [90.0] * 2,
        vehicles=[
            *(vehicle(f"c{n}", hour=0, need_kwh=16.0) for n in range(2)),
            vehicle("w", hour=1, need_kwh=8.0, option="C1"),
            vehicle("v", hour=1, need_kwh=4.0, option="C1"),
        ],
        station={"chargers": 2, "max_kw": 8.0},
    )
    told = explained(scenario)
    assert told.cause.kind == "chargers"
    assert by(told)["chargers"] == 2


def test_headroom_or_chargers():
    """c still owes 12 kWh in slots 1 and 2 of 8 kW each and holds the only charger in both.

    With a second charger v's 4 kWh go beside it; with 4 kW more c is done in one slot.
    """
    scenario = roomy(
        [8.0] * 3,
        vehicles=[
            vehicle("c", hour=0, need_kwh=20.0, option="C1"),
            vehicle("v", hour=1, need_kwh=4.0, option="C2"),
        ],
        station={"chargers": 1, "max_kw": 12.0},
        options=(
            {"name": "C1", "price_per_kwh": 0.4, "average_kw": 8.0},
            {"name": "C2", "price_per_kwh": 0.4, "average_kw": 2.0},
        ),
    )
    told = explained(scenario)
    assert told.cause.kind == "headroom or chargers"
    assert by(told) == {"chargers": 1, "headroom": 4.0, "time": 1}
    assert "and more of either would do" in told.detail


def test_headroom_and_chargers_only_together():
    """One slot, the only charger and all headroom held by a contract without slack."""
    scenario = roomy(
        [8.0] * 3,
        vehicles=[vehicle("c", hour=0, need_kwh=24.0), vehicle("v", hour=1, need_kwh=8.0)],
        station={"chargers": 1, "max_kw": 8.0},
    )
    told = explained(scenario)
    assert told.cause.kind == "headroom and chargers"
    assert told.cause.taken.chargers == (1,)
    assert [t for t, _ in told.cause.taken.headroom] == [1]
    assert helpless(told) == {"chargers", "headroom", "price"}
    assert by(told) == {"time": 2}
    assert "beyond the horizon" in told.remedy


def test_too_little_time():
    """Room for 35 kWh in its two hours, 30 and 5 kW, but its own charger takes 8 in each."""
    scenario = roomy(
        [30.0, 5.0, 30.0], vehicles=[vehicle("v", need_kwh=16.0)], station={"max_kw": 8.0}
    )
    told = explained(scenario)
    assert told.cause.kind == "feeder"
    assert told.cause.by_pace
    assert "but not at the pace of its own 8 kW" in told.detail
    assert told.cause.taken.headroom == ((1, Element("node", "a")),)
    assert by(told) == {"headroom": 3.0, "time": 1}


def test_price():
    """Energy at 0.5 $/kWh, the driver pays 0.4; a cent of P1's tolerance on 8 kWh."""
    scenario = roomy([50.0] * 2, price=[0.5, 0.7], vehicles=[vehicle("v", need_kwh=8.0)])
    told = explained(scenario)
    assert told.cause.kind == "energy"
    assert told.cause.reason.cost == pytest.approx(4.0, abs=1e-9)
    assert told.cause.loss == pytest.approx(0.8, abs=0.01)
    assert "even its cheapest hour costs 0.5 $/kWh" in told.detail
    assert by(told).keys() == {"price"}
    assert 0.1 <= by(told)["price"] <= 0.1 + 0.03 / 8
    assert helpless(told) == {"chargers", "headroom", "time"}


def test_displaced_from_the_cheap_hour():
    """8 kWh at 0.1 would pay, but that hour goes to c; the next costs 0.6."""
    scenario = roomy(
        [8.0, 50.0, 50.0],
        price=[0.1, 0.6, 0.6],
        vehicles=[
            vehicle("c", hour=0, need_kwh=8.0),
            vehicle("v", hour=0, need_kwh=8.0, option="C2"),
        ],
        station={"max_kw": 8.0},
    )
    told = explained(scenario)
    assert told.cause.kind == "outbid"
    assert [r.vehicle for r in told.cause.displaced_by] == ["c"]


def test_price_where_contracts_have_the_cheap_hour():
    """At 01:00 a contract without slack fills the hour at 0.1 $/kWh; those after cost 0.6."""
    scenario = roomy(
        [8.0, 8.0, 50.0],
        price=[0.1, 0.1, 0.6],
        vehicles=[vehicle("c", hour=0, need_kwh=16.0), vehicle("v", hour=1, need_kwh=8.0, **C2)],
        station={"max_kw": 8.0},
    )
    told = explained(scenario)
    assert told.cause.kind == "contracts cost"
    assert told.cause.reason.cost == pytest.approx(4.8, abs=0.01)
    assert "even its cheapest" not in told.detail
    assert by(told)["headroom"] > 0


def test_displaced_by_a_better_paying_newcomer():
    """One slot of 8 kW, two ask for it; C1 pays 0.4, C3 0.25 for the same energy."""
    options = (
        {"name": "C1", "price_per_kwh": 0.4, "average_kw": 8.0},
        {"name": "C3", "price_per_kwh": 0.25, "average_kw": 8.0},
    )
    scenario = roomy(
        [8.0, 50.0, 50.0],
        vehicles=[
            vehicle("rich", need_kwh=8.0, option="C1"),
            vehicle("v", need_kwh=8.0, option="C3"),
        ],
        options=options,
    )
    told = explained(scenario)
    assert told.cause.kind == "outbid"
    assert [r.vehicle for r in told.cause.displaced_by] == ["rich"]
    assert told.cause.loss == pytest.approx(8 * 0.15, abs=0.011)
    assert "if rich ($3.20) had not come" in told.detail
    remedies = by(told)
    assert remedies["headroom"] == 8.0
    assert remedies["time"] == 1
    assert 0.15 <= remedies["price"] <= 0.15 + 0.03 / 8
    assert helpless(told) == {"chargers"}


def test_who_took_its_place_where_yet_another_would_have_taken_it_next():
    """One slot for one of three: without rich it is mid who comes in, not v."""
    options = tuple(
        {"name": name, "price_per_kwh": price, "average_kw": 8.0}
        for name, price in (("C1", 0.4), ("C3", 0.3), ("C4", 0.25))
    )
    scenario = roomy(
        [8.0, 50.0, 50.0],
        vehicles=[
            vehicle("rich", need_kwh=8.0, option="C1"),
            vehicle("mid", need_kwh=8.0, option="C3"),
            vehicle("v", need_kwh=8.0, option="C4"),
        ],
        options=options,
    )
    told = explained(scenario)
    assert told.cause.reason.by == ("rich",)
    assert not told.cause.only_by
    assert "beside the others admitted then, it would have come in if rich" in told.detail
    assert explained(scenario, "mid").cause.only_by


def test_no_chargers():
    told = explained(
        roomy([50.0] * 2, vehicles=[vehicle("v", need_kwh=8.0)], station={"chargers": 0})
    )
    assert told.cause.kind == "no chargers"
    assert by(told) == {"chargers": 1}


def test_too_slow_for_the_chargers():
    """It takes 1.5 kW, a charger gives at least 2."""
    told = explained(roomy([50.0] * 9, vehicles=[vehicle("v", need_kwh=6.0, max_kw=1.5)]))
    assert told.cause.kind == "unattainable"
    assert by(told) == {"amount": -4.5, "max_kw": 0.5}
    assert helpless(told) == {"chargers", "headroom", "time", "price"}


def test_between_whole_intervals():
    """5 kWh is more than one hour at 4 kW and less than two at 3."""
    scenario = roomy(
        [50.0] * 9,
        vehicles=[vehicle("v", need_kwh=5.0, max_kw=4.0)],
        station={"min_kw": 3.0},
    )
    told = explained(scenario)
    assert told.cause.kind == "unattainable"
    amounts = [r.amount for r in told.remedies if r.kind == "amount"]
    assert amounts == [1.0, -1.0]
    assert by(told)["max_kw"] == 1.0


def test_a_full_battery_takes_no_more():
    scenario = roomy(
        [50.0] * 9,
        vehicles=[vehicle("v", need_kwh=5.0, max_kw=4.0, battery_kwh=5.0 / 0.75)],
        station={"min_kw": 3.0},
    )
    amounts = [r.amount for r in explained(scenario).remedies if r.kind == "amount"]
    assert amounts == [-1.0]


def test_too_late_in_the_day():
    told = explained(roomy([50.0] * 3, vehicles=[vehicle("v", hour=2, need_kwh=16.0)]))
    assert told.cause.kind == "end of horizon"
    assert by(told) == {"time": 1, "amount": -6.0}
    assert "at 04:00 (beyond the horizon" in told.remedy


def test_after_the_last_interval_has_begun():
    told = explained(roomy([50.0] * 3, vehicles=[vehicle("v", hour=2.5, need_kwh=16.0)]))
    assert told.cause.kind == "after the end"
    assert told.interval == 3
    assert by(told) == {"time": 2}


def test_a_refusal_by_a_rule_is_told_as_the_rule_s_and_p1_s_answer_beside_it():
    """c holds the charger from 00:00 on by the rule; P1 would have let c wait for v."""
    scenario = roomy(
        [50.0] * 3,
        vehicles=[
            vehicle("c", need_kwh=8.0, **C2),
            vehicle("v", need_kwh=8.0),
        ],
        station={"chargers": 1, "max_kw": 8.0},
    )
    trace = run_day(start_day(scenario), by_rule(first_come))
    told = explain_vehicle(trace, "v")
    assert told.cause.kind == "rule"
    assert told.text == (
        "Refused because the rule of precedence would then not serve everyone in time: first "
        "come, first served. P1, asked at that moment, would have admitted it."
    )


def test_where_p1_too_would_refuse_what_a_rule_did_its_reason_and_remedy_are_told_as_its_own():
    scenario = roomy(
        [50.0] * 3,
        vehicles=[vehicle("c", need_kwh=16.0), vehicle("v", hour=1, need_kwh=8.0)],
        station={"chargers": 1, "max_kw": 8.0},
    )
    trace = run_day(start_day(scenario), by_rule(first_come))
    told = explain_vehicle(trace, "v")
    assert told.cause.kind == "rule"
    assert f"P1, asked at that moment, would have refused it because {CLAUSES['chargers']}" in (
        told.detail
    )
    assert told.remedy.startswith("By P1: It would have been admitted with 1 more charger")


def test_a_step_whose_solver_failed_says_so_and_p1_is_asked_anew():
    def failing(snapshot):
        raise SolverFailure("nothing found")

    scenario = roomy([50.0] * 2, vehicles=[vehicle("v", need_kwh=8.0)])
    trace = run_day(start_day(scenario), failing)
    told = explain_vehicle(trace, "v")
    assert told.cause.kind == "fallback"
    assert told.detail == (
        f"Refused because {CLAUSES['fallback']}. P1, asked at that moment, would have admitted it."
    )
