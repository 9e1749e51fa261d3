"""The Live page as a person handles it."""

import re

from playwright.sync_api import FloatRect, Locator, Page, expect

SETTLED = (
    "[data-testid=stApp][data-test-connection-state=CONNECTED][data-test-script-state=notRunning]"
)
CHARTS = ("schedule", "admissions", "load", "voltages")
QUIET_MS = 150


def at_rest(element: Locator) -> FloatRect:
    """Where an element is once it has stopped moving: a popover glides into its place."""
    before = None
    while before is None or element.bounding_box() != before:
        before = element.bounding_box()
        element.page.wait_for_timeout(200)
    return before


class LivePage:
    """Buttons and fields by what they are called, and what the page then says."""

    def __init__(self, page: Page, address: str) -> None:
        self.page = page
        self.address = address

    def open(self, path: str = "/") -> "LivePage":
        """Open the app and wait for all charts."""
        self.page.goto(self.address + path)
        self.page.locator(".st-key-chart_voltages .main-svg").first.wait_for()
        return self.settled()

    def settled(self) -> "LivePage":
        """Wait until no script runs and none begins anew."""
        for _ in range(2):
            self.page.wait_for_selector(SETTLED)
            self.page.wait_for_timeout(QUIET_MS)
        self.page.wait_for_selector(SETTLED)
        return self

    def press(self, key: str) -> "LivePage":
        """Press the button of this key."""
        self.page.locator(f".st-key-{key} button").first.click()
        return self.settled()

    def step_to(self, hour: int) -> "LivePage":
        """Step until the clock shows this hour.

        One at a time: Streamlit drops a click that comes while the page is still being drawn.
        """
        for following in range(self.hour + 1, hour + 1):
            self.press("step").shows(following).settled()
        return self

    def shows(self, hour: int) -> "LivePage":
        """Wait until the clock shows this hour."""
        expect(self.page.locator(".st-key-clock")).to_have_text(f"{hour:02d}:00")
        return self

    @property
    def hour(self) -> int:
        return int(self.page.locator(".st-key-clock").inner_text().strip()[:2])

    @property
    def sentence(self) -> Locator:
        return self.page.locator(".st-key-sentence")

    def figure(self, label: str) -> Locator:
        """The value of a key figure."""
        metric = self.page.locator(".st-key-figures [data-testid=stMetric]")
        found = metric.filter(has_text=re.compile(rf"^{label}"))
        return found.locator("[data-testid=stMetricValue]")

    def field(self, label: str) -> Locator:
        return self.page.get_by_label(label, exact=True)

    def type(self, label: str, value: str) -> "LivePage":
        """Type a number into a field of the sidebar."""
        self.field(label).fill(value)
        self.field(label).press("Enter")
        return self.settled()

    def chart(self, name: str) -> Locator:
        return self.page.locator(f".st-key-chart_{name} .js-plotly-plot")
