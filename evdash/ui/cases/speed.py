"""A promise of speed: what it costs, and what it must pay."""

from evdash.metrics.service import totals
from evdash.ui.cases import figures as f
from evdash.ui.cases.case import Case, Claim, Figures, Press, Walk
from evdash.ui.cases.doing import Ask, Finish, Reset, Set


def _as_fast(walk: Walk) -> Figures:
    slow, fast = totals(walk.after(1)), totals(walk.after(2))
    return {
        "slow_hours": f.promised_hours(walk.after(1), "C2"),
        "fast_hours": f.promised_hours(walk.after(2), "C2"),
        "slow": slow.admitted,
        "fast": fast.admitted,
        "slow_profit": slow.profit,
        "fast_profit": fast.profit,
    }


def _after_midnight(walk: Walk) -> Figures:
    slow, fast = (
        f.drawn_kwh(trace.steps) - f.drawn_kwh(f.between(trace, "00:00"))
        for trace in (walk.after(1), walk.after(2))
    )
    until = walk.after(1).scenario.arrivals_until
    last = walk.after(1).scenario.time_of(until or 0)
    return {"slow_kwh": slow, "fast_kwh": fast, "until": f"{last:%H:%M}"}


def _all_first(walk: Walk) -> Figures:
    fast = totals(walk.after(2))
    dear = totals(Finish().done(walk.runs[3]).trace)
    prices = {o.name: o.price_per_kwh for o in walk.after(3).scenario.option}
    return {
        "admitted": dear.admitted,
        "fast": fast.admitted,
        "profit": dear.profit,
        "slow_profit": totals(walk.after(1)).profit,
        "fast_profit": fast.profit,
        "more": prices["C1"] - prices["C2"],
    }


SPEED = Case(
    "What does a promise of speed cost?",
    "past-midnight",
    "Option C1 pays more and is promised sooner; C2 pays less and may take until after midnight.",
    (
        Press((Finish(),), "note how many are admitted, and the profit"),
        Press(
            (Set("option.C2.average_kw", "C2 average", 9.6), Reset(), Finish()),
            "compare: C2 is now as fast as C1, at its own price",
        ),
        Press(
            (
                Set("option.C2.average_kw", "C2 average", 4.8),
                Reset(),
                Ask("everyone_picks", "Everyone picks C1"),
            ),
            "read before and after",
        ),
    ),
    (
        Claim(
            "**Speed alone.** C2 is promised back after {fast_hours:.1f} h in place of "
            "{slow_hours:.1f} h on average: {fast} are admitted in place of {slow}, and profit "
            "falls from {slow_profit:.0f} to {fast_profit:.0f} \\$.",
            _as_fast,
            lambda n: (
                n["fast_hours"] < n["slow_hours"] - 1
                and n["fast"] < n["slow"]
                and n["fast_profit"] < n["slow_profit"] - 10
            ),
        ),
        Claim(
            "**What is lost is the night.** From {until} on nobody arrives any more, and only "
            "those promised a later return can be charged: they get {slow_kwh:.0f} kWh then, and "
            "{fast_kwh:.0f} kWh with the fast promise.",
            _after_midnight,
            lambda n: n["until"] == "00:00" and n["fast_kwh"] < 0.8 * n["slow_kwh"],
        ),
        Claim(
            "**Speed at its price.** When everyone picks C1, about as few are admitted, "
            "{admitted}, but each kWh pays {more:.2f} \\$ more than on C2: profit is "
            "{profit:.0f} \\$.",
            _all_first,
            lambda n: (
                abs(n["admitted"] - n["fast"]) <= 5
                and n["profit"] > n["slow_profit"] + 10 > n["fast_profit"]
            ),
        ),
    ),
    "A late time of return lets the station put a charge into hours with room. A soon one asks "
    "for the evening, when room is short: fewer can be served, so it has to pay more.",
)
