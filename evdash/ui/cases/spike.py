"""A price spike: whom the price lets in."""

from evdash.domain.trace import Step
from evdash.metrics.service import totals
from evdash.ui.cases import figures as f
from evdash.ui.cases.case import Case, Claim, Figures, Press, Walk
from evdash.ui.cases.doing import Curve, Finish, Reset


def _spike(walk: Walk) -> Figures:
    trace = walk.after(1)
    steps = f.between(trace, "00:00")
    paid = [option.price_per_kwh for option in trace.scenario.option]
    dear = [step for step in steps if _price(step) > max(paid)]
    prices = [_price(step) for step in dear] or [0.0]
    return {
        "when": f.when(dear),
        "low": min(prices),
        "high": max(prices),
        "least_paid": min(paid),
        "most_paid": max(paid),
    }


def _price(step: Step) -> float:
    return float(step.inputs.scenario.price_per_kwh[step.interval])


def _within(walk: Walk) -> Figures:
    hours = f.between(walk.after(1), "13:00", "20:00")
    return {
        "kwh": f.drawn_kwh(hours),
        "asked": f.asked(hours),
        "too_dear": f.refused(hours, "energy"),
    }


def _who_can_wait(walk: Walk) -> Figures:
    trace = walk.after(1)
    evening = f.between(trace, "18:00", "21:00")
    after = f.between(trace, "21:00")
    given = f.charged_kwh(trace, evening)
    later = sum(given.get(step.interval, 0.0) for step in after)
    return {
        "admitted": f.asked(evening) - f.refused(evening),
        "share": 100 * later / (sum(given.values()) or 1.0),
    }


def _ordinary(walk: Walk) -> Figures:
    spike, ordinary = totals(walk.after(1)), totals(walk.after(2))
    return {
        "spike": spike.admitted,
        "ordinary": ordinary.admitted,
        "asked": spike.arrived,
        "asked_ordinary": ordinary.arrived,
    }


SPIKE = Case(
    "What does an expensive afternoon do?",
    "price-spike",
    "A heat wave: in the afternoon energy costs a multiple of what drivers pay for it.",
    (
        Press((Finish(),), "look at **Charging schedule** and **Load and price**"),
        Press(
            (Curve("Ordinary"), Reset(), Finish()),
            "compare how many are admitted",
        ),
    ),
    (
        Claim(
            "**The price.** A kWh costs the station {low:.2f} to {high:.2f} \\$ {when}; drivers "
            "pay {least_paid:.2f} or {most_paid:.2f} \\$.",
            _spike,
            lambda n: n["when"] == "from 13:00 to 21:00" and n["low"] > 2 * n["most_paid"],
        ),
        Claim(
            "**13:00–20:00.** The station draws nothing. {too_dear} of the {asked} who ask in "
            "these hours are refused because their energy costs no less than they pay.",
            _within,
            lambda n: n["kwh"] < 0.05 and n["asked"] > n["too_dear"] > n["asked"] / 2,
        ),
        Claim(
            "**Who can wait is welcome.** {admitted} who ask between 18:00 and 21:00 are "
            "admitted: {share:.0f} % of their energy is drawn after 21:00, when it is cheap again.",
            _who_can_wait,
            lambda n: n["admitted"] > 1 and n["share"] > 80,
        ),
        Claim(
            "**With ordinary prices** {ordinary} of the same {asked} vehicles are admitted, with "
            "the spike {spike}.",
            _ordinary,
            lambda n: n["asked"] == n["asked_ordinary"] and n["ordinary"] > 1.5 * n["spike"],
        ),
    ),
    "A promise is kept at any price, so the station makes none that would lose money. The price "
    "decides whom it takes on, not only when it charges them.",
)
