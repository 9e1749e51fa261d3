"""The race: the same day for everyone, measured by the oracle, told in plain words."""

import csv

import pytest
from hypothesis import HealthCheck, given, settings

from evdash.domain.words import money
from evdash.errors import InputError
from evdash.files.exchange import output_folder
from evdash.files.race_folder import is_race, policies_table, read_race, write_race
from evdash.files.tables import write_table
from evdash.horizon.day import run_day, start_day
from evdash.horizon.inputs import prepare
from evdash.metrics.service import totals
from evdash.policies.race import CONTESTANTS, race
from evdash.policies.race_words import race_sentences, race_table
from evdash.policies.registry import RULES
from tests.builders import generator, line, make_scenario, scenarios, vehicle

CENT = 0.01


@pytest.fixture(scope="module")
def crowded():
    """Room for one at a time; who asks first pays less than who asks an hour later."""
    return make_scenario(
        station={"chargers": 1, "max_kw": 10.0},
        price=(0.1, 0.1, 0.1, 0.1),
        lines=(line("s", "a", rating=12.0),),
        vehicles=[
            vehicle("first", hour=0, need_kwh=40.0, option="C2", battery_kwh=80.0),
            vehicle("second", hour=1, need_kwh=30.0, battery_kwh=60.0, option="C1"),
        ],
        options=(
            {"name": "C1", "price_per_kwh": 0.9, "average_kw": 10.0},
            {"name": "C2", "price_per_kwh": 0.2, "average_kw": 10.0},
        ),
    )


@pytest.fixture(scope="module")
def raced(crowded):
    return race(prepare(crowded), CONTESTANTS)


def test_everyone_meets_the_same_day(crowded, raced):
    for lap in raced.laps:
        assert lap.service.arrived == 2
        trace = start_day(crowded)
        rule = RULES[lap.policy]
        alone = totals(run_day(trace, rule.make(trace.inputs), decide=rule.decide))
        assert lap.service.profit == alone.profit


def test_who_cannot_take_part_is_told_why(raced):
    assert "bid-price" not in {lap.policy for lap in raced.laps}
    assert "arrivals.forecast" in raced.absent["bid-price"]


def test_what_foresight_is_worth(raced):
    """P1 takes the first, 40 kWh at 0.2 $; the oracle waits for 30 kWh at 0.9 $. Energy 0.1 $."""
    assert raced.most_profit == pytest.approx(30 * 0.8)
    assert raced.value_of_foresight == pytest.approx(30 * 0.8 - 40 * 0.1)
    told = race_sentences(raced)
    assert "worth $20.00 on this day" in told[0]
    assert "16.7 % of it" in told[0]
    assert money(-1.5) == "−$1.50"


def test_only_who_keeps_no_limits_breaks_any(raced):
    broken = {lap.policy: lap.limits_broken for lap in raced.laps}
    assert broken.pop("uncoordinated") > 0
    assert set(broken.values()) == {0}
    assert all(lap.is_sound for lap in raced.laps)  # it is not to keep them
    damage = next(told for told in race_sentences(raced) if "uncoordinated" in told)
    assert "In the linearised model, charging exceeds limits: uncoordinated (" in damage
    assert "; none under " in damage


@settings(max_examples=8, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scenario=scenarios(max_vehicles=6))
def test_none_within_the_limits_earns_more_than_the_proven_most(scenario):
    found = race(prepare(scenario), CONTESTANTS)
    for lap in found.laps:
        assert lap.is_sound
        if lap.keeps_limits:
            assert lap.service.profit <= found.most_profit + CENT


@settings(max_examples=4, deadline=None, suppress_health_check=[HealthCheck.too_slow])
@given(scenario=scenarios(max_vehicles=0))
def test_anticipating_keeps_limits_and_stays_below_the_proven_most(scenario):
    known = make_scenario(arrivals=generator(vehicles_per_day=60.0)).arrivals
    found = race(prepare(scenario.replacing(arrivals=known)), ("bid-price", "oracle"))
    assert [lap.policy for lap in found.laps] == ["oracle", "bid-price"]
    assert all(lap.is_sound for lap in found.laps)
    ours = found.lap("bid-price")
    assert ours.service.profit <= found.most_profit + CENT
    assert all(price is None or price >= 0 for price in ours.capacity_price_per_kwh)


def test_a_day_with_events_has_no_proven_most(crowded):
    happening = crowded.replacing(events=make_scenario(events=EVENTS, price=(0.1,) * 4).events)
    found = race(prepare(happening), ("p1", "oracle"))
    assert found.most_profit is None
    assert found.value_of_foresight is None
    assert {lap.policy for lap in found.laps} == {"p1", "oracle"}


EVENTS = [{"interval": 3, "event": "chargers", "value": 2}]


def test_it_tells_how_far_it_is_and_can_be_stopped(crowded):
    told = []
    race(prepare(crowded), ("p1", "fcfs"), told.append)
    assert [t.done for t in told] == sorted(t.done for t in told)
    assert (told[0].total, told[-1].done) == (8, 8)

    class StopError(Exception):
        pass

    def stop(_):
        raise StopError

    with pytest.raises(StopError):
        race(prepare(crowded), ("p1",), stop)


def test_files_read_back_as_they_were(raced, tmp_path):
    def place(force: bool):
        return output_folder(tmp_path, "race", is_race, force)

    with place(force=False) as out:
        write_race(out, raced)
    assert read_race(tmp_path / "race.json") == raced
    refused = (tmp_path / "refusals.csv").read_text(encoding="utf-8").splitlines()
    assert len(refused) == 1 + sum(len(lap.turned_down) for lap in raced.laps)
    told = [str(one.reason) for lap in raced.laps for one in lap.turned_down]
    assert [row["reason"] for row in csv.DictReader(refused)] == told
    head, *rows = write_table(*policies_table(raced)).splitlines()
    assert len(rows) == len(raced.laps)
    assert {"policy", "profit", "acceptance_C1", "ac_overload_kva"} <= set(head.split(","))
    with pytest.raises(InputError, match="--force"), place(force=False):
        pass
    (tmp_path / "letter.txt").write_text("mine", encoding="utf-8")
    with place(force=True) as out:
        write_race(out, raced)
    assert (tmp_path / "letter.txt").read_text(encoding="utf-8") == "mine"
    (tmp_path / "race.json").write_text("{}", encoding="utf-8")
    with pytest.raises(InputError, match="no race"):
        read_race(tmp_path / "race.json")


def test_the_table_has_a_cell_for_every_policy_and_units_in_the_head(raced):
    table = dict(race_table(raced))
    assert all(len(cells) == len(raced.laps) for cells in table.values())
    place = [lap.policy for lap in raced.laps].index("p1")
    assert table["Profit, $"][place] == "4.00"
    assert table["Acceptance of C2, %"][place] == "100.0"
