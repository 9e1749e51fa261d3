"""What is said of one vehicle: numbers of its contract, what events did to it, what was moved."""

from evdash.domain.events import Event
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.happen import happen
from evdash.metrics.outlook import outlook
from evdash.metrics.vehicles import vehicle_day
from evdash.scheduling.p1 import p1_policy
from evdash.ui.vehicles.words import change_lines, contract_lines, ledger_lines, price
from tests.builders import make_scenario, vehicle


def begun():
    one = vehicle("a", need_kwh=12.0, option="C2", battery_kwh=40.0)
    return step(start_day(make_scenario(price=[0.1] * 6, vehicles=[one])), p1_policy())


def test_a_contract_in_words_has_all_its_terms() -> None:
    trace = begun()
    day = vehicle_day(trace, "a")
    text = " ".join(contract_lines(day, trace.scenario, outlook(trace)))
    for term in (
        "12.0\u00a0kWh",
        "25\u00a0%",
        "55\u00a0%",
        "\\$0.30",
        "4\u00a0kW",
        "03:00",
        "\\$3.60",
    ):
        assert term in text, term
    assert ledger_lines(day, outlook(trace)) == []


def test_what_an_event_takes_away_is_said_in_red() -> None:
    trace = happen(begun(), (Event(interval=1, event="chargers", value=0.0),))
    day = vehicle_day(trace, "a")
    lines = ledger_lines(day, outlook(trace))
    missing = 12.0 - day.record.delivered_kwh
    assert missing > 0.1
    assert f":red[**{missing:.1f}\u00a0kWh of it cannot be kept**]" in lines[0]
    assert "0 chargers work from now on" in lines[0]
    assert f"Short by {missing:.1f}" in lines[-1]


def test_moves_are_told_across_what_happened_in_between() -> None:
    """Prices turn round at 02:00, so what was planned for later is brought forward."""
    prices = [0.3, 0.3, 0.3, 0.1, 0.1, 0.1]
    one = vehicle("a", need_kwh=18.0, option="C2", battery_kwh=40.0)
    trace = step(start_day(make_scenario(price=prices, vehicles=[one])), p1_policy())
    assert change_lines(trace, "a", outlook(trace)) == []
    dear = Event(interval=1, event="price_factor", value=9.0, from_interval=3, until_interval=6)
    done = run_day(happen(trace, (dear,)), p1_policy())
    lines = change_lines(done, "a", outlook(done))
    assert lines[-1][0] == 1
    assert "from 03:00 to 01:00" in lines[-1][1]


def test_prices_have_as_many_digits_as_they_need() -> None:
    assert price(0.35) == "\\$0.35"
    assert price(0.1234) == "\\$0.1234"
