"""Days of a few intervals in which everything can bind: strategies for horizon and P1."""

from typing import Any

from hypothesis import strategies as st

from evdash.domain.plan import Snapshot
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.horizon.advance import snapshot_of
from tests.builders import OPTIONS, make_scenario, node, vehicle

THIRD = {"name": "C3", "price_per_kwh": 0.02, "average_kw": 2.5}
LOAD_KW = 40.0
ASKED = st.tuples(
    st.sampled_from([12.0, 9.0, 15.5, 16.0, 7.0, 6.6]), st.sampled_from([None, 6.6, 5.0])
)
"""Energy asked for in kW·intervals, and the vehicle's own limit in kW."""


def with_headroom(headroom_kw: list[float]) -> dict[str, Any]:
    """Node and load such that the station at `a` may draw just `headroom_kw` per interval."""
    room = max([LOAD_KW, *headroom_kw])
    return {
        "nodes": (node("s"), node("a", load_kw=room, load_kvar=0.0, rating_kva=room)),
        "load": [(room - kw) / room for kw in headroom_kw],
    }


@st.composite
def small_days(draw: st.DrawFn, max_intervals: int = 4, max_vehicles: int = 3) -> Scenario:
    """A day with scarce chargers, headroom and time, prices of either sign and many ties."""
    intervals = draw(st.sampled_from([*range(1, max_intervals), *[max_intervals] * max_intervals]))
    minutes = draw(st.sampled_from([15, 20, 60]))
    prices = st.sampled_from([-0.1, 0.05, 0.1, 0.1, 0.15, 0.2, 0.25, 0.35, 0.6])
    rooms = st.sampled_from([25.0, 14.0, 13.0, 10.0, 7.3, 5.5, 2.0, 1.9, 0.0])
    needs = st.one_of(
        st.sampled_from([4.0, 10.0, 20.0, 6.0, 3.9, 2.0, 0.5]), st.floats(0.2, 4 * max_intervals)
    )
    last_minute = max(1, (intervals - 1) * minutes)  # nearly everybody comes in time
    vehicles = [
        vehicle(
            f"{n}",
            hour=draw(st.sampled_from([0, 0, 0, 1, last_minute // 2, last_minute])) / 60,
            need_kwh=draw(needs) * minutes / 60,
            battery_kwh=120.0,
            option=draw(st.sampled_from(["C2", "C2", "C1", "C3"])),
            max_kw=draw(st.sampled_from([None, None, 6.6, 6.0, 3.3, 2.0, 1.5])),
        )
        for n in range(draw(st.sampled_from([*[max_vehicles] * 4, *range(max_vehicles)])))
    ]
    return make_scenario(
        **with_headroom([draw(rooms) for _ in range(intervals)]),
        price=[draw(prices) for _ in range(intervals)],
        vehicles=vehicles,
        options=(*OPTIONS, THIRD),
        station={
            "chargers": draw(st.sampled_from([1, 2, 2, 3, 1, 0])),
            "min_kw": draw(st.sampled_from([2.0, 3.3, 3.3, 0.0])),
        },
        interval_minutes=minutes,
    )


@st.composite
def crowded_days(draw: st.DrawFn, max_vehicles: int = 4, max_intervals: int = 4) -> Scenario:
    """Everybody there from the start, nearly all admitted, most of it best charged later."""
    intervals = draw(st.sampled_from([max_intervals, max_intervals - 1]))
    minutes = draw(st.sampled_from([30, 15, 60]))
    vehicles = [
        vehicle(f"{n}", need_kwh=kw * minutes / 60, battery_kwh=120.0, option="C2", max_kw=max_kw)
        for n, (kw, max_kw) in enumerate(draw(st.lists(ASKED, min_size=2, max_size=max_vehicles)))
    ]
    prices = st.sampled_from([0.05, 0.1, 0.15, 0.2, 0.25])
    return make_scenario(
        **with_headroom([draw(st.sampled_from([25.0, 20.0, 14.0])) for _ in range(intervals)]),
        price=sorted((draw(prices) for _ in range(intervals)), reverse=draw(st.booleans())),
        vehicles=vehicles,
        station={"chargers": 3, "min_kw": draw(st.sampled_from([2.0, 3.3]))},
        interval_minutes=minutes,
    )


def snapshots(trace: Trace) -> list[Snapshot]:
    """What was known at each step taken."""
    return [snapshot_of(step.inputs, step.before) for step in trace.steps]
