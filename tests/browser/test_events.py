"""A charger fails at 18:00: the warning is read, it is let happen, and the ledger tells why."""

from playwright.sync_api import expect

from tests.browser.live import LivePage


def test_chargers_fail_at_six_in_the_evening(live: LivePage) -> None:
    live.step_to(18)
    page = live.page
    page.get_by_text("Something happens").click()
    live.settled()
    expect(page.get_by_text("At 18:00", exact=True)).to_be_visible()
    live.type("How many of 12", "10")
    live.press("event_ask")
    effect = page.locator(".st-key-event_effect")
    expect(effect).to_contain_text("At 18:00, 10 of the chargers stop working")
    expect(effect).to_contain_text("promised to 6 vehicles cannot be delivered in time")
    expect(effect).to_contain_text("This would keep every promise: 3 more chargers")
    expect(effect.get_by_role("table")).to_contain_text("PEV-030")
    expect(live.field("Chargers")).to_have_value("12")  # nothing has happened yet
    live.press("event_apply")
    expect(live.field("Chargers")).to_have_value("2")
    short = page.locator(".st-key-promises_short")
    expect(short).to_contain_text("Nobody new is admitted")
    expect(live.sentence).to_contain_text("6 promises cannot be kept as things stand")
    expect(live.figure("Broken")).to_have_text("6")
    expect(live.chart("schedule").get_by_text("Short of its promise")).to_be_visible()
    ledger = page.locator(".st-key-ledger")
    expect(ledger).to_contain_text("6 short")
    expect(ledger).to_contain_text("at 18:00, 10 of the chargers stop working")
    expect(ledger).to_contain_text("kWh can no longer be delivered in time")
    live.press("finish").shows(0)
    expect(live.sentence).to_contain_text("6 promises broken")
    expect(ledger).to_contain_text("PEV-030 was promised 28.3 kWh by 23:00")
