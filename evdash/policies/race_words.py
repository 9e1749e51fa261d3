"""A race told: its figures as a table, and what it shows in plain sentences."""

from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service
from evdash.policies.race import PAPERS, Lap, Race

ANTICIPATING, LAWLESS = "bid-price", "uncoordinated"


def race_table(race: Race) -> list[tuple[str, list[str]]]:
    """A row for each figure that any policy has: its head with the unit, a cell for each policy."""
    rows = []
    for figure in figures_of(Service):
        values = [getattr(lap.service, figure.name) for lap in race.laps]
        if any(value is not None for value in values):
            rows.append((figure.head, [figure.told(value) for value in values]))
        if figure.name == "acceptance":
            rows += _acceptance_by_option(race)
    return rows


def _acceptance_by_option(race: Race) -> list[tuple[str, list[str]]]:
    tables = [lap.service.acceptance_by_option for lap in race.laps]
    options = sorted({option for table in tables for option in table})
    return [
        (f"Acceptance of {option}, %", [_per_cent(table.get(option)) for table in tables])
        for option in options
    ]


def race_sentences(race: Race) -> list[str]:
    """What foresight is worth, how much of it statistics give, what no coordination does."""
    told = (_foresight(race), _anticipation(race), _best_rule(race), _damage(race), _unsound(race))
    return [sentence for sentence in told if sentence]


def _foresight(race: Race) -> str:
    papers, worth, most = race.lap(PAPERS), race.value_of_foresight, race.most_profit
    if papers is None or worth is None or most is None:
        return ""
    return (
        f"Knowing in advance who will come is worth {usd(worth)} on this day: at most {usd(most)} "
        f"could have been earned within the limits, and the paper's rule earned "
        f"{usd(papers.service.profit)}, {_per_cent(papers.service.profit_of_best)} % of it."
    )


def _anticipation(race: Race) -> str:
    papers, ours, worth = race.lap(PAPERS), race.lap(ANTICIPATING), race.value_of_foresight
    if papers is None or ours is None:
        return ""
    more = ours.service.profit - papers.service.profit
    side = "more" if more >= 0 else "less"
    share = f", {100 * more / worth:.0f} % of what foresight is worth" if worth and more > 0 else ""
    return (
        f"bid-price, which knows the statistics of arrivals and not who will come, earned "
        f"{usd(abs(more))} {side} than the paper's rule{share}."
    )


def _best_rule(race: Race) -> str:
    rules = [lap for lap in (race.lap(name) for name in ("fcfs", "edf", "llf")) if lap]
    papers = race.lap(PAPERS)
    if not rules or papers is None:
        return ""
    best = max(rules, key=lambda lap: lap.service.profit)
    less = papers.service.profit - best.service.profit
    side = "less" if less >= 0 else "more"
    return (
        f"The best rule of precedence, {best.title.lower()}, earned {usd(abs(less))} {side} than "
        "the paper's rule."
    )


def _damage(race: Race) -> str:
    lawless = race.lap(LAWLESS)
    if lawless is None:
        return ""
    found = lawless.service
    done = []
    if found.ac_voltage_node_intervals:
        done.append(
            f"takes voltage beyond its limits in {found.ac_voltage_node_intervals} "
            f"node-intervals, by up to {found.ac_voltage_depth_pu:.4f} pu and for up to "
            f"{found.ac_voltage_longest_h:g} h"
        )
    if found.ac_overload_intervals:
        done.append(
            f"overloads lines, transformers or nodes in {found.ac_overload_intervals} "
            f"element-intervals, by up to {found.ac_overload_kva:.0f} kVA and for up to "
            f"{found.ac_overload_longest_h:g} h"
        )
    if found.ac_unsolved:
        done.append(f"leaves AC power flow without a solution in {found.ac_unsolved} intervals")
    if not done:
        return "Uncoordinated charging keeps within every limit of the feeder in AC on this day."
    return f"In full AC power flow, uncoordinated charging {'; it '.join(done)}."


def _unsound(race: Race) -> str:
    broken = [lap for lap in race.laps if not lap.is_sound]
    return "" if not broken else f"Limits or promises were broken by {_names(broken)}."


def _names(laps: list[Lap]) -> str:
    return ", ".join(lap.policy for lap in laps)


def usd(value: float) -> str:
    """Money in $, to the cent."""
    return f"{'−' if round(value, 2) < 0 else ''}${abs(value):,.2f}"


def _per_cent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f}"
