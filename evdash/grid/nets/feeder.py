"""What a network has become: the feeder of a scenario."""

from collections.abc import Mapping
from dataclasses import dataclass

from evdash.domain.scenario import Line, Node


@dataclass(frozen=True, slots=True)
class ConvertedFeeder:
    """Nodes and lines of a scenario, what `[feeder]` needs, and what was done to get there.

    `node_of_bus` names the node of every supplied bus by index. `scale_of_node` is what the
    scenario's voltage must be multiplied by to be per unit of the bus's own nominal voltage;
    1 but behind transformers whose ratio is another than their buses' nominal voltages have.
    A voltage limit is None where the file's buses do not agree on one.
    """

    name: str
    nodes: tuple[Node, ...]
    lines: tuple[Line, ...]
    source_node: str
    source_voltage_pu: float
    base_kv: float
    base_mva: float
    voltage_min_pu: float | None
    voltage_max_pu: float | None
    node_of_bus: Mapping[int, str]
    scale_of_node: Mapping[str, float]
    notices: tuple[str, ...]

    @property
    def load_kw(self) -> float:
        """All loads together at their peak, kW."""
        return sum(node.load_kw or 0.0 for node in self.nodes)

    @property
    def has_generation(self) -> bool:
        return any(node.generation_kw for node in self.nodes)

    def heaviest_node(self) -> str:
        """The node with the largest load that is not the source."""
        others = [node for node in self.nodes if node.node != self.source_node]
        return max(others, key=lambda node: node.load_kw or 0.0).node
