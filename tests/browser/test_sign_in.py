"""A server behind a sign-in: in by Streamlit's own OpenID Connect, and out again."""

from pathlib import Path

from playwright.sync_api import Browser, expect

from tests.browser.conftest import serving, visiting
from tests.browser.provider import BUTTON, CLIENT, EMAIL, provider

SECRETS = """
[auth]
redirect_uri = "http://127.0.0.1:{{port}}/oauth2callback"
cookie_secret = "a secret long enough for the signature of a cookie"
client_id = "{client}"
client_secret = "the provider of the test asks for none"
server_metadata_url = "{address}/.well-known/openid-configuration"
"""


def test_in_by_the_providers_page_and_out_again(browser: Browser, tmp_path: Path) -> None:
    with provider() as company:
        secrets = tmp_path / "secrets.toml"
        secrets.write_text(SECRETS.format(client=CLIENT, address=company.address))
        with (
            serving(options=(f"--secrets.files={secrets}",)) as address,
            visiting(browser) as page,
        ):
            page.goto(f"{address}/vehicles?run=somebody-elses")
            expect(page.get_by_text("asks who you are")).to_be_visible()
            expect(page.get_by_text("Open it once more")).to_be_visible()
            assert page.get_by_role("button", name="Step").count() == 0
            page.get_by_role("button", name="Sign in", exact=True).click()
            page.get_by_role("link", name=BUTTON).click()
            expect(page.get_by_text(f"Signed in as {EMAIL}")).to_be_visible()
            page.get_by_role("button", name="Step 1 h", exact=True).click()
            expect(page.get_by_text("1 of 24 intervals")).to_be_visible()
            page.goto(f"{address}/feeder")
            expect(page.get_by_text(f"Signed in as {EMAIL}")).to_be_visible()
            page.get_by_role("button", name="Sign out", exact=True).click()
            expect(page.get_by_text("asks who you are")).to_be_visible()
