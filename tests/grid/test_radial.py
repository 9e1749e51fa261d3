"""Networks that are not radial are told, with the place."""

import pytest

from evdash.errors import InputError
from tests.builders import line, make_scenario, node

NODES = [node("s"), node("a"), node("b"), node("c")]
TREE = [line("s", "a"), line("a", "b"), line("b", "c")]


def faults_of(lines, nodes=NODES, source="s"):
    with pytest.raises(InputError) as caught:
        make_scenario(nodes=nodes, lines=lines, feeder={"source_node": source})
    return [(fault.place, fault.found) for fault in caught.value.faults]


def test_radial_network_passes():
    make_scenario(nodes=NODES, lines=TREE)


def test_meshed_network_names_the_line_that_closes_the_loop_and_the_loop():
    ((place, found),) = faults_of([*TREE, line("c", "a")])
    assert place == "lines.3"
    assert found.startswith("a loop")
    assert sorted(set(found.removeprefix("a loop ").split(" – "))) == ["a", "b", "c"]


def test_every_loop_is_told():
    nodes = [*NODES, node("d")]
    faults = faults_of([*TREE, line("c", "a"), line("c", "d"), line("d", "s")], nodes)
    assert [found.split(" ")[:2] for _, found in faults] == [["a", "loop"]] * 2


def test_doubly_fed_network_is_a_loop_through_the_source():
    ((place, found),) = faults_of([*TREE, line("s", "c")])
    assert place == "lines.3"
    assert " s" in found


def test_disconnected_nodes_are_named():
    ((place, found),) = faults_of([line("s", "a"), line("b", "c")])
    assert (place, found) == ("lines", "nodes without a way to the source s: b, c")


def test_loop_away_from_the_source_is_told_beside_the_disconnection():
    nodes = [*NODES, node("d")]
    faults = faults_of([line("s", "a"), line("b", "c"), line("c", "d"), line("d", "b")], nodes)
    assert sorted(place for place, _ in faults) == ["lines", "lines.3"]


@pytest.mark.parametrize("second", [line("a", "b"), line("b", "a")])
def test_parallel_line_is_told_in_either_direction(second):
    ((place, found),) = faults_of([*TREE, second])
    assert place == "lines.3"
    assert found == f"a second line between {second['from_node']} and {second['to_node']}"


def test_self_loop_is_told():
    assert faults_of([*TREE, line("b", "b")]) == [("lines.3", "a line from b to itself")]


def test_line_to_a_node_that_does_not_exist_is_told_once():
    faults = faults_of([*TREE, line("c", "nowhere")])
    assert faults == [("lines.3.to_node", "'nowhere'")]


def test_source_that_does_not_exist_is_told_once():
    assert faults_of(TREE, source="x") == [("feeder.source_node", "'x'")]


def test_any_order_and_direction_of_lines_is_the_same_feeder():
    turned = [line("c", "b"), line("a", "s"), line("b", "a")]
    make_scenario(nodes=NODES[::-1], lines=turned)
