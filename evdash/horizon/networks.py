"""The network models: where limits on station power come from, and what certifies a plan."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from evdash.checker.feeder import FeederCheck
from evdash.domain.limits import LimitRows
from evdash.domain.scenario import Scenario
from evdash.domain.trace import Inputs, LimitCheck, Network
from evdash.grid.aclimits import AcFeeder, ac_limit_rows
from evdash.grid.reduction import limit_rows


@dataclass(frozen=True, slots=True)
class NetworkModel:
    """How a feeder's limits become rows, and how a schedule is held against them."""

    rows: Callable[[Scenario], LimitRows]
    check: Callable[[Scenario], LimitCheck]


NETWORKS: Mapping[Network, NetworkModel] = {
    "lindistflow": NetworkModel(limit_rows, FeederCheck),
    "ac": NetworkModel(ac_limit_rows, AcFeeder),
}


def limit_check(inputs: Inputs) -> LimitCheck:
    """The certificate of the network model in force."""
    return NETWORKS[inputs.network].check(inputs.scenario)
