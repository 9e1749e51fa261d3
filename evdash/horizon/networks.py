"""The network models: where limits on station power come from, and what certifies a plan."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from evdash.checker.feeder import FeederCheck
from evdash.domain.limits import LimitRows
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs, LimitCheck, Network
from evdash.grid.reduction import limit_rows


@dataclass(frozen=True, slots=True)
class NetworkModel:
    """How a feeder's limits become rows, and how a schedule is held against them."""

    rows: Callable[[Scenario], LimitRows]
    check: Callable[[Scenario], LimitCheck]


def _ac_rows(scenario: Scenario) -> LimitRows:
    # power flows in batch are slow to import, and a day in the linearised model needs none
    from evdash.grid.aclimits import ac_limit_rows  # noqa: PLC0415

    return ac_limit_rows(scenario)


def _ac_check(scenario: Scenario) -> LimitCheck:
    from evdash.grid.aclimits import AcFeeder  # noqa: PLC0415

    return AcFeeder(scenario)


NETWORKS: Mapping[Network, NetworkModel] = {
    "lindistflow": NetworkModel(limit_rows, FeederCheck),
    "ac": NetworkModel(_ac_rows, _ac_check),
}


def limit_check(inputs: Inputs) -> LimitCheck:
    """The certificate of the network model in force."""
    return NETWORKS[inputs.network].check(inputs.scenario)
