"""The run's own files: audited clean also where the day was changed on the way."""

import pytest

from evdash.audit.audit import audit_run
from evdash.domain.arrivals import Arrival
from evdash.files.draft import zipped
from evdash.files.exchange import output_folder
from evdash.files.run_export import RunLabel
from evdash.files.run_folder import is_run, write_run
from evdash.horizon.day import run_day, start_day, step
from evdash.horizon.guests import joined
from evdash.reports.account import account, edited, verdict_on
from evdash.reports.again import decided_again, earlier_run
from evdash.reports.html import report_html
from evdash.scheduling.p1 import p1_policy
from evdash.ui import run as runs
from tests.builders import START, generator, make_scenario, vehicle


def handed_on(trace):
    label = RunLabel("p1", trace.inputs.network, trace.inputs.given.arrivals.seed, 1.0)
    return account(trace, verdict_on(trace), label)


def decide(scenario, network, rule):
    trace = start_day(scenario, network)
    return run_day(trace, rule.make(trace.inputs), decide=rule.decide)


@pytest.mark.parametrize("drawn", [False, True])
def test_who_comes_beside_the_scenarios_arrivals_is_in_the_files(tmp_path, drawn):
    """A vehicle added by hand has a contract like any other: the files must tell of it."""
    known = {"arrivals": generator(vehicles_per_day=40.0)} if drawn else {}
    scenario = make_scenario(
        vehicles=[] if drawn else [vehicle("V1", 0.0), vehicle("V2", 2.0)], **known
    )
    trace = step(start_day(scenario), p1_policy())
    guest = Arrival(
        vehicle="Guest-1", arrival=START, option="C1", battery_kwh=20, soc_in=0.25, soc_out=0.5
    )
    trace = run_day(joined(trace, guest), p1_policy())
    told = handed_on(trace)
    with output_folder(tmp_path / "run", "run", is_run, force=True) as claim:
        write_run(claim, told.files)
    assert "Guest-1" in told.files["vehicles.csv"]
    assert audit_run(tmp_path / "run").findings == ()
    again = decided_again(earlier_run(tmp_path / "run"), decide)
    assert [s.station_kw for s in again.steps] == [s.station_kw for s in trace.steps]


def test_events_made_in_mid_day_are_in_the_files(tmp_path):
    vehicles = [vehicle(f"V{n}", n / 4, need_kwh=12) for n in range(8)]
    run = runs.open_run(None, make_scenario(vehicles=vehicles))
    run = runs.stepped(run, p1_policy())
    run = runs.edited(run, "chargers", {"station.chargers": 4})
    trace = run_day(run.trace, p1_policy())
    assert trace.scenario.station.chargers == 4
    assert edited(trace) == {}
    told = handed_on(trace)
    with output_folder(tmp_path / "run", "run", is_run, force=True) as claim:
        write_run(claim, told.files)
    assert audit_run(tmp_path / "run").findings == ()
    decided_again(earlier_run(tmp_path / "run"), decide)


def test_settings_changed_by_hand_are_told_as_what_the_files_cannot_tell():
    vehicles = [vehicle(f"V{n}", n / 4, need_kwh=12) for n in range(8)]
    run = runs.open_run(None, make_scenario(vehicles=vehicles))
    run = runs.stepped(run, p1_policy())
    run = runs.edited(run, "price", {"option.C1.price_per_kwh": 0.9})
    run = runs.stepped(run, p1_policy())
    run = runs.rewired(run, "ac")
    trace = run_day(run.trace, p1_policy())
    found = edited(trace)
    (price,), (network,) = found.values()
    assert list(found) == ["01:00", "02:00"]
    assert (price.place, price.before, price.after) == ("option.C1.price_per_kwh", "0.4", "0.9")
    assert (network.before, network.after) == ("lindistflow", "ac")
    text = report_html(handed_on(trace))
    assert "Settings were changed by hand on the way" in text
    assert "At 01:00, option.C1.price_per_kwh from 0.4 to 0.9." in text


def test_a_zip_of_the_files_is_the_same_each_time(usual):
    assert zipped(dict(usual.files), "run") == zipped(dict(usual.files), "run")
