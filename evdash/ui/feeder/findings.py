"""What the Feeder page's pieces have in common: flows, layout, what AC found. Each made once."""

from evdash.charts.feeder_layout import Layout, layout_of
from evdash.charts.feeder_moment import Moment
from evdash.charts.voltage_map import AcVoltages, MapWay
from evdash.domain.breach import Breach
from evdash.domain.outlook import Outlook
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Trace
from evdash.metrics.ac import AcPoint
from evdash.metrics.feeder import Flows, day_breaches, flows
from evdash.ui.parts import view
from evdash.ui.referee import referee
from evdash.ui.session import Session

AC_PATIENCE_SECONDS = 0.06
WAYS: dict[MapWay, str] = {
    "with": "With charging",
    "without": "Without",
    "difference": "Difference",
}


def flows_of(session: Session) -> Flows:
    """What flows through each line."""
    return session.once("flows", lambda: flows(session.run.trace, view(session)))


def layout_in(session: Session) -> Layout:
    """Where nodes are drawn."""
    scenario: Scenario = session.run.trace.scenario
    return session.once("layout", lambda: layout_of(scenario))


def ac_points(session: Session) -> dict[int, AcPoint]:
    """What AC power flow found of the intervals executed; the rest comes later."""
    return referee.findings(session.run.trace, AC_PATIENCE_SECONDS)


def ac_voltages(points: dict[int, AcPoint]) -> AcVoltages:
    """Node voltages by interval."""
    return {interval: point.voltage_pu for interval, point in points.items()}


def moment_at(session: Session, interval: int, way: MapWay) -> Moment:
    """The feeder in one interval."""
    trace, ahead = session.run.trace, view(session)
    loaded, without = session.once("breaches", lambda: _breaches(trace, ahead))
    return Moment(
        scenario=trace.inputs_at(interval).scenario,
        outlook=ahead,
        flows=flows_of(session),
        layout=layout_in(session),
        interval=interval,
        way=way,
        linear=tuple(breach for breach in loaded if breach.interval == interval),
        without=tuple(breach for breach in without if breach.interval == interval),
        ac=ac_points(session).get(interval),
    )


def _breaches(trace: Trace, ahead: Outlook) -> tuple[tuple[Breach, ...], tuple[Breach, ...]]:
    """Limits exceeded in the linearised model, with the station and without it."""
    station_kw = ahead.station_kw
    return day_breaches(trace, station_kw), day_breaches(trace, 0 * station_kw)
