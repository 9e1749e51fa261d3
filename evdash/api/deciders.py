"""Who decides and in which network model, as a program says it: checked before anything is run."""

from collections.abc import Callable, Sequence

from evdash.domain.plan import Snapshot
from evdash.errors import Fault, InputError
from evdash.horizon.networks import NETWORKS
from evdash.policies.registry import Rule, given, own

Own = Callable[[Snapshot], object]
"""A policy of somebody's own: it answers a mapping from vehicle to power in kW, or a Plan."""


def rule_of(policy: str | Own) -> Rule:
    """A policy by its name, or one of somebody's own, whose plans are certified like ours."""
    if isinstance(policy, str):
        return given(policy, "policy")
    if not callable(policy):
        rule = "should be a name, or a function that takes a snapshot"
        raise InputError([Fault("policy", f"{policy!r}", rule)])
    return own(policy)


def check_some(policies: object) -> None:
    """Raise InputError for what is not a row of policies, or none at all."""
    if isinstance(policies, str) or not isinstance(policies, Sequence) or not policies:
        rule = 'should be a list of policies, as ["p1", "fcfs"]'
        raise InputError([Fault("policies", f"{policies!r}", rule)])


def rules_of(policies: Sequence[str | Own]) -> dict[str, Rule]:
    """Policies that are to race, each under a name of its own."""
    check_some(policies)
    rules: dict[str, Rule] = {}
    for policy in policies:
        rule = rule_of(policy)
        if rule.name in rules and not isinstance(policy, str):
            allowed = "should have names that tell them apart"
            raise InputError([Fault("policies", f"two functions called {rule.name}", allowed)])
        rules[rule.name] = rule
    return rules


def check_network(network: str) -> None:
    """Raise InputError for a network model there is none of."""
    if network not in NETWORKS:
        rule = f"should be one of {', '.join(NETWORKS)}"
        raise InputError([Fault("network", repr(network), rule)])
