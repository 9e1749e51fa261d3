"""A race told: its figures as a table, and what it shows in plain sentences."""

from collections.abc import Iterator, Mapping

from evdash.domain.plan import is_outside
from evdash.domain.trace import Network
from evdash.domain.words import element_name, money
from evdash.metrics.declared import figures_of
from evdash.metrics.service import Service
from evdash.metrics.verdict import FULL_AC, LINEARISED
from evdash.metrics.verdict_words import MODEL, Wording, in_brief
from evdash.policies.race import ORACLE, PAPERS, Race

ANTICIPATING = "bid-price"
LIMITS_OF: Mapping[Network, str] = {
    LINEARISED: "of the linearised model",
    FULL_AC: "of AC power flow",
}


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
    """What foresight is worth, how much of it statistics give, and who exceeds which limits."""
    earned = (_foresight(race), _anticipation(race), _best_rule(race), *_from_outside(race))
    told = (*earned, *_limits(race), _promises(race), _unsound(race))
    return [sentence for sentence in told if sentence]


def _foresight(race: Race) -> str:
    papers, worth, most = race.lap(PAPERS), race.value_of_foresight, race.most_profit
    if papers is None or worth is None or most is None:
        return ""
    beyond = race.network != FULL_AC and most_is_over_in_ac(race)
    return (
        f"Knowing in advance who will come is worth {money(worth)} on this day: at most "
        f"{money(most)} could have been earned within the limits {LIMITS_OF[race.network]}"
        f"{' (by AC power flow such a day exceeds limits)' if beyond else ''}, and the paper's "
        f"rule earned {money(papers.service.profit)}, {_per_cent(papers.service.profit_of_best)} % "
        "of it."
    )


def most_is_over_in_ac(race: Race) -> bool:
    """Whether the day that earns the most any policy could exceeds limits by AC power flow."""
    best = race.lap(ORACLE)
    return best is not None and bool(best.verdict(FULL_AC).by_charging)


def _anticipation(race: Race) -> str:
    papers, ours, worth = race.lap(PAPERS), race.lap(ANTICIPATING), race.value_of_foresight
    if papers is None or ours is None:
        return ""
    more = ours.service.profit - papers.service.profit
    side = "more" if more >= 0 else "less"
    share = f", {100 * more / worth:.0f} % of what foresight is worth" if worth and more > 0 else ""
    return (
        f"bid-price, which knows the statistics of arrivals and not who will come, earned "
        f"{money(abs(more))} {side} than the paper's rule{share}."
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
        f"The best rule of precedence, {best.title.lower()}, earned {money(abs(less))} {side} than "
        "the paper's rule."
    )


def _from_outside(race: Race) -> Iterator[str]:
    """What each policy from outside earned, and where its plan did not count, and why."""
    papers = race.lap(PAPERS)
    for lap in race.laps:
        if not is_outside(lap.policy):
            continue
        if papers is not None:
            more = lap.service.profit - papers.service.profit
            side = "more" if more >= 0 else "less"
            yield f"{lap.title}, a policy from outside, earned {money(abs(more))} {side} than P1."
        kept = {
            one.interval: one.reason.where
            for one in lap.turned_down
            if one.reason.kind == "fallback"
        }
        if kept:
            first = min(kept)
            often = f"{len(kept)} interval{'s' * (len(kept) > 1)}"
            yield (
                f"In {often} in which somebody asked the last plan was kept in place of that of "
                f"{lap.title}; first at {race.times[first]:%H:%M}, {kept[first]}."
            )


def _limits(race: Race) -> list[str]:
    """Under whom charging exceeds which limits in either model, and under whom it does not."""
    wording = Wording(
        lambda one: element_name(one.element),
        lambda t: f"{race.times[t]:%H:%M}",
    )
    told = []
    for network, model in MODEL.items():
        verdicts = {lap.policy: lap.verdict(network) for lap in race.laps}
        over = {name: found for name, found in verdicts.items() if found.by_charging}
        free = [name for name in verdicts if name not in over]
        if not over:
            told.append(f"{_capital(model)}, charging exceeds no limit under any policy.")
            continue
        each = "; ".join(f"{name} ({in_brief(found, wording)})" for name, found in over.items())
        head = f"{_capital(model)}, charging exceeds limits"
        if free:
            told.append(f"{head}: {each}; none under {', '.join(free)}.")
        else:
            told.append(f"{head} under every policy: {each}.")
    return told


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]


def _promises(race: Race) -> str:
    broken = [
        f"{lap.policy} ({lap.service.broken} of {lap.service.admitted})"
        for lap in race.laps
        if lap.service.broken
    ]
    return f"Promises were broken by {', '.join(broken)}." if broken else ""


def _unsound(race: Race) -> str:
    broken = [lap.policy for lap in race.laps if not lap.is_sound]
    if not broken:
        return ""
    return (
        f"What was to keep every promise, and every limit {MODEL[race.network]}, did not: "
        f"{', '.join(broken)}."
    )


def _per_cent(share: float | None) -> str:
    return "–" if share is None else f"{100 * share:.1f}"
