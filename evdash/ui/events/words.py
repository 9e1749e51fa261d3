"""What happened, or would, in plain words. Text for Streamlit's Markdown; user text is escaped."""

from collections.abc import Sequence

from evdash.domain.events import Event
from evdash.domain.outlook import Outlook
from evdash.domain.trace import Happening
from evdash.domain.vehicles import Contract
from evdash.horizon.relief import Relief
from evdash.metrics.ledger import LedgerEntry
from evdash.ui.words import clock, counted, plain

TOLD_KWH = 0.05
STATUS = {
    "open": "under way",
    "kept": "✓ kept",
    "short": "! short",
    "released": "~ cut short by its driver",
}

WORST_FIRST = ("short", "released", "open", "kept")


def events_told(events: Sequence[Event], outlook: Outlook) -> str:
    """What happens, `10 of the chargers stop working`."""

    def at(interval: int) -> str:
        return clock(outlook.times[interval], outlook)

    return plain("; ".join(event.told(at) for event in events))


def contract_told(contract: Contract, outlook: Outlook) -> str:
    """Who it is, what it is owed and until when, as a plain line to choose from."""
    by = clock(outlook.times[contract.request.deadline_interval], outlook)
    return f"{contract.vehicle}, {contract.owed_kwh + contract.short_kwh:.1f} kWh owed by {by}"


def effect_told(happening: Happening) -> str:
    """What it does to promises, in a sentence or two."""
    short = [one for one in happening.revisions if one.short_kwh > 0]
    good = [one for one in happening.revisions if one.short_kwh < 0]
    sentences = []
    if short:
        sentences.append(
            f"**{happening.short_kwh:.1f} kWh promised to {counted(len(short), 'vehicle')} cannot "
            "be delivered in time.** Nobody new is admitted while a promise is short."
        )
        if happening.proven:
            sentences.append("No schedule would miss less.")
    if good:
        made = -sum(one.short_kwh for one in good)
        sentences.append(f"{made:.1f} kWh that were short can be delivered after all.")
    sentences += [
        f"{plain(one.vehicle)} gives up {-one.promised_kwh:.1f} kWh, which is no broken promise."
        for one in happening.revisions
        if one.promised_kwh < -TOLD_KWH
    ]
    if happening.note:
        sentences.append(plain(happening.note) + ".")
    if not sentences:
        sentences.append("**Every promise can still be kept.**")
    return " ".join(sentences)


def short_rows(happening: Happening, outlook: Outlook) -> list[dict[str, object]]:
    """Whom it would leave short, by how much, until when."""
    return [
        {
            "Vehicle": one.vehicle,
            "Promised, kWh": round(one.after.promised_kwh, 1),
            "Would get, kWh": round(one.after.request.need_kwh, 1),
            "Missing, kWh": round(one.after.short_kwh, 1),
            "Back by": clock(outlook.times[one.after.request.deadline_interval], outlook),
        }
        for one in happening.revisions
        if one.short_kwh > 0
    ]


def remedies_told(found: Relief, interval_hours: float) -> str:
    """What else would keep every promise, as a list."""
    unsure = "" if found.sure else " (less may do, or something else: the search was cut short)"
    told = []
    if found.chargers:
        told.append(f"**{counted(found.chargers, 'more charger')}**")
    if found.headroom_kw:
        told.append(f"**{found.headroom_kw:.1f} kW more** headroom from the feeder")
    if found.later_intervals:
        hours = found.later_intervals * interval_hours
        told.append(f"those short **waiting {hours:g} h longer**")
    if not told:
        if unsure:
            return "No one thing that alone would keep every promise was found in time."
        return "No one thing alone would keep every promise."
    if len(told) == 1:
        return f"This would keep every promise: {told[0]}{unsure}."
    listed = "\n".join(f"- {one}" for one in told)
    return f"Any one of these would keep every promise{unsure}:\n{listed}"


def story_told(entry: LedgerEntry, outlook: Outlook) -> str:
    """One contract that did not go as promised, in a sentence."""
    name, by = plain(entry.vehicle), clock(outlook.times[entry.promised_by_interval], outlook)
    told = f"**{name}** was promised {entry.promised_kwh:.1f} kWh by {by}"
    for change in entry.changes:
        at = clock(outlook.times[change.interval], outlook)
        what = f"at {at}, {events_told(change.events, outlook)}"
        if change.short_kwh > TOLD_KWH:
            told += f"; {what}, and {change.short_kwh:.1f} kWh can no longer be delivered in time"
        elif change.short_kwh < -TOLD_KWH:
            told += f"; {what}, and {-change.short_kwh:.1f} kWh of that was made good"
        elif change.more_kwh < -TOLD_KWH:
            told += f"; {what} and gave up {-change.more_kwh:.1f} kWh"
        elif change.more_kwh > TOLD_KWH:
            told += f"; {what}, and was granted {change.more_kwh:.1f} kWh"
    end = {
        "short": f"{entry.short_kwh:.1f} kWh are missing",
        "kept": "the promise is kept",
        "released": "the promise is kept but for that",
        "open": "the promise can be kept",
    }
    if outlook.now >= entry.revised_by_interval:
        return f"{told}. It got {entry.delivered_kwh:.1f} kWh; {end[entry.status]}."
    return f"{told}. It has {entry.delivered_kwh:.1f} kWh so far; {end[entry.status]}."


def ledger_rows(entries: Sequence[LedgerEntry], outlook: Outlook) -> list[dict[str, object]]:
    """The ledger as a table, promises short or cut first; else in order of arrival."""

    def at(interval: int | None) -> str:
        return "" if interval is None else clock(outlook.times[interval], outlook)

    return [
        {
            "Vehicle": entry.vehicle,
            "Promised, kWh": round(entry.promised_kwh, 2),
            "By": at(entry.promised_by_interval),
            "As agreed now, kWh": round(entry.revised_kwh, 2),
            "Now by": at(entry.revised_by_interval),
            "Delivered, kWh": round(entry.delivered_kwh, 2),
            "Missing, kWh": round(entry.short_kwh, 2),
            "What became of it": STATUS[entry.status],
            "Known since": at(entry.since_interval),
            "Because": entry.cause,
        }
        for entry in sorted(entries, key=lambda entry: WORST_FIRST.index(entry.status))
    ]


def summary_told(entries: Sequence[LedgerEntry]) -> str:
    """The ledger in a line, `41 kept, 2 short`."""
    words = {"kept": "kept", "open": "under way", "short": "short", "released": "cut by drivers"}
    counts = {status: sum(e.status == status for e in entries) for status in words}
    told = ", ".join(f"{count} {words[status]}" for status, count in counts.items() if count)
    return told or "no promise made yet"
