"""The whole story in a real browser: open, read, step, edit, go back, run to the end."""

import re
from pathlib import Path

from playwright.sync_api import Browser, expect

from tests.browser.conftest import serving, visiting
from tests.browser.live import CHARTS, LivePage, at_rest

ALTERNATIVE_TEXTS = ("Chart of", "Stacked bars", "Lines over the day", "Voltages of")


def test_the_story_from_start_to_end(live: LivePage) -> None:
    live.shows(0)
    expect(live.sentence).to_contain_text("The day is about to begin")
    expect(live.sentence).to_contain_text("18:00 will be its tightest hour")
    live.step_to(2)
    expect(live.sentence).to_contain_text("4 of 4 PEVs admitted")
    live.press("back").shows(1)
    live.press("finish")
    expect(live.sentence).to_contain_text("51 of 99 PEVs admitted, every one charged in full")
    expect(live.figure("Profit")).to_have_text(re.compile(r"\$255\.7\d"))
    for name in CHARTS:
        expect(live.chart(name)).to_have_count(1)
    # The AC check comes by itself, a little later, and puts the overload down to the station.
    live.page.get_by_text("By AC power flow, charging exceeds 1 limit").first.wait_for()
    live.settled().press("reset").shows(0)


def test_edits_in_mid_day_take_effect_from_now_on(live: LivePage) -> None:
    live.step_to(3)
    delivered = live.figure("Delivered").inner_text()
    live.type("C1 price, $/kWh", "0.5")
    live.type("C1 average, kW", "8")
    live.type("Arrival seed", "7")
    live.type("Vehicles a day", "150")
    live.type("Chargers", "8")
    log = live.page.locator("[data-testid=stSidebar]").get_by_text("from 03:00").locator("..")
    for told in ("0.35 → 0.5", "9.6 → 8", "1 → 7", "100 → 150", "12 → 8"):
        expect(log).to_contain_text(told)
    live.page.get_by_role("radio", name="Spike").click()
    expect(log).to_contain_text("energy price of 21 intervals")
    live.shows(3)
    expect(live.figure("Delivered")).to_have_text(delivered)
    live.settled().step_to(4)


def test_prices_by_the_hour_can_be_edited(live: LivePage) -> None:
    live.page.get_by_role("button", name="Edit prices by the hour").click()
    grid = live.page.locator("[data-testid=stPopoverBody] canvas").first
    box = at_rest(grid)
    live.page.mouse.dblclick(box["x"] + box["width"] * 0.75, box["y"] + 52)
    cell = live.page.locator("#portal textarea, #portal input, input.gdg-input").first
    cell.fill("0.9")
    cell.press("Enter")
    live.page.get_by_text("energy price of 1 interval").wait_for()


def test_a_wrong_or_impossible_edit_is_answered_and_not_applied(live: LivePage) -> None:
    answer = live.page.locator(".st-key-answer")
    live.type("C1 average, kW", "50")
    expect(answer).to_contain_text("max_kw")
    expect(live.field("C1 average, kW")).to_have_value("9.6")
    live.step_to(18)
    live.type("Chargers", "0")
    expect(answer).to_contain_text("It would break")
    expect(answer).to_contain_text("kWh would be missing")
    expect(live.field("Chargers")).to_have_value("12")
    live.step_to(19)
    expect(answer).to_have_count(0)


def test_double_clicks_step_once_or_twice_but_never_corrupt(live: LivePage) -> None:
    for _ in range(4):
        before = live.hour
        live.page.locator(".st-key-step button").first.dblclick(delay=5)
        expect(live.page.locator(".st-key-clock")).not_to_have_text(f"{before:02d}:00")
        live.settled()
    assert 4 <= live.hour <= 8  # a second click may come late, but none counts twice
    live.press("finish")
    expect(live.sentence).to_contain_text("51 of 99 PEVs admitted, every one charged in full")


def test_play_goes_on_by_itself_until_paused(live: LivePage) -> None:
    live.page.locator(".st-key-play button").first.click()
    live.shows(3)
    live.page.locator(".st-key-play button").first.click()
    expect(live.page.locator(".st-key-play button").first).to_contain_text("Play")
    hour = live.settled().hour
    live.page.wait_for_timeout(1500)
    assert live.hour == hour


def test_another_preset_and_back_by_its_address(live: LivePage) -> None:
    live.step_to(1)
    live.page.get_by_label("Preset", exact=True).click()
    live.page.get_by_role("option", name="Voltage limited").click()
    expect(live.sentence).to_contain_text("node 652")
    live.settled().shows(0)
    expect(live.field("Chargers")).to_have_value("140")
    assert "preset=voltage-limited" in live.page.url
    live.page.reload()
    expect(live.sentence).to_contain_text("node 652")
    expect(live.field("Chargers")).to_have_value("140")


def test_a_run_survives_a_reload_another_browser_and_a_new_server(
    browser: Browser, tmp_path: Path
) -> None:
    store = str(tmp_path)
    with serving(store) as address, visiting(browser) as page:
        live = LivePage(page, address).open().step_to(3)
        live.type("Chargers", "9").step_to(5)
        page.reload()
        live.shows(5).settled()
        expect(live.field("Chargers")).to_have_value("9")
        delivered = live.settled().step_to(6).figure("Delivered").inner_text()
        link = page.url.removeprefix(address)
        assert "run=" in link
    with serving(store) as address, visiting(browser) as page:
        live = LivePage(page, address).open(link).shows(6)
        expect(live.figure("Delivered")).to_have_text(delivered)
        live.step_to(7).press("undo").shows(6)


def test_the_run_stays_when_another_page_is_looked_at(live: LivePage) -> None:
    live.step_to(3)
    for group, name in (("Learn", "Vehicles"), ("Learn", "Live")):
        live.page.get_by_test_id("stTopNavSection").filter(has_text=group).click()
        live.page.get_by_test_id("stTopNavDropdownLink").filter(has_text=name).click()
        live.page.wait_for_url(f"**/{'' if name == 'Live' else name.lower()}?*run=*")
        live.settled()
    live.shows(3).step_to(4)


def test_a_prompt_tells_before_and_after_and_is_undone(live: LivePage) -> None:
    live.step_to(2).press("prompt_fewer_chargers")
    told = live.page.locator(".st-key-outcome")
    expect(told).to_contain_text("Before")
    expect(told).to_contain_text("51 of 99")
    expect(live.field("Chargers")).to_have_value("10")
    live.press("undo")
    expect(told).to_have_count(0)
    expect(live.field("Chargers")).to_have_value("12")
    live.press("cases")
    live.page.get_by_role("button", name="Open this case").nth(1).click()
    expect(live.page.locator(".st-key-case")).to_contain_text("expensive afternoon")
    live.settled().shows(0)


def test_a_vehicle_comes_by_hand(live: LivePage) -> None:
    live.step_to(2).press("add_pev")
    live.page.get_by_role("button", name="Ask for a charge").click()
    live.settled().step_to(3)
    expect(live.page.locator(".st-key-decision")).to_contain_text("Guest-1")


def test_charts_have_names_and_tables_and_fit_the_window(live: LivePage) -> None:
    live.step_to(2)
    for text in ALTERNATIVE_TEXTS:
        expect(live.page.get_by_label(re.compile(text)).first).to_be_attached()
    for width in (1366, 1920):
        live.page.set_viewport_size({"width": width, "height": 900})
        main = live.settled().page.locator("[data-testid=stMain]")
        assert main.evaluate("e => e.scrollWidth - e.clientWidth") == 0
    live.page.get_by_text("As a table").first.click()
    expect(live.page.get_by_label("The numbers of the schedule chart").first).to_be_attached()


def test_dark_mode(browser: Browser, server: str) -> None:
    with visiting(browser, "dark") as page:
        LivePage(page, server).open().step_to(1)
        ground = page.evaluate(
            "getComputedStyle(document.querySelector('[data-testid=stApp]')).backgroundColor"
        )
        assert max(int(part) for part in ground[4:-1].split(",")) < 64


def test_a_cold_deep_link_finds_its_page(browser: Browser) -> None:
    with serving() as fresh, visiting(browser) as page:
        live = LivePage(page, fresh).open("/live?preset=price-spike")
        assert page.title() == "evdash"
        expect(page.get_by_role("radio", name="Spike")).to_be_checked()
        live.step_to(1)
