"""What else would have kept every promise: held against a little less and just enough."""

import pytest

from evdash.domain.trace import Trace
from evdash.horizon.happen import happen
from evdash.horizon.relief import Relief, relief
from tests.horizon.days import with_headroom
from tests.horizon.test_events import begun, event


def short_kwh(trace: Trace) -> float:
    return sum(c.short_kwh for c in (*trace.state.contracts, *trace.state.waiting))


def test_chargers_as_many_as_are_needed_and_no_more():
    trace = begun([2, 5, 5])
    none_left = happen(trace, [event("chargers", value=0)])
    found = relief(none_left)
    assert found == Relief(chargers=1, headroom_kw=None, later_intervals=None)
    assert short_kwh(happen(none_left, [event("chargers_return", value=1)])) == 0


def test_headroom_to_the_watt():
    """10 kWh are owed to each in two intervals and 9 kW are left: 1 kW more is just enough."""
    trace = begun([2, 5, 5])
    rated = happen(trace, [event("rating", subject="node:a", value=9.0)])
    found = relief(rated)
    assert found.chargers is None
    assert found.headroom_kw == pytest.approx(1.0, abs=1e-4)
    assert short_kwh(happen(trace, [event("rating", subject="node:a", value=10.001)])) == 0
    assert short_kwh(happen(trace, [event("rating", subject="node:a", value=9.99)])) > 0


def test_a_later_return_where_time_is_what_is_missing():
    """9 kW for 20 kWh: two intervals hold 18, three hold them all."""
    rated = happen(begun([2, 5, 5]), [event("rating", subject="node:a", value=9.0)])
    assert relief(rated).later_intervals == 1
    slow = happen(begun([2, 5, 5]), [event("rating", subject="node:a", value=6.0)])
    assert relief(slow).later_intervals == 2
    never = happen(begun([2, 5, 5]), [event("rating", subject="node:a", value=4.0)])
    assert relief(never).later_intervals is None


def test_where_both_are_missing_neither_alone_helps():
    trace = begun([4, 4, 4], **with_headroom([30.0, 9.0, 9.0, 0.0, 0.0]))
    both = happen(trace, [event("chargers", value=0), event("load_factor", value=2.0)])
    assert relief(both) == Relief(None, None, None)
