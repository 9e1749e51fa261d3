"""Pages' own addresses, answered so that a browser knows where its server is.

Streamlit's browser side looks for the server below a page's address first: two requests that
fail, told in the console as errors, and a wait before it looks one place up.
"""

from importlib.resources import files
from pathlib import Path

import streamlit as st
from starlette.requests import Request
from starlette.responses import HTMLResponse
from starlette.routing import Route

HEAD = "<head>"
WHERE = (
    '<script>window.__streamlit = { BACKEND_BASE_URL: new URL(".", location.href).href };</script>'
)


def routes(pages: Path) -> list[Route]:
    """Routes of the addresses of the pages in a folder, each one step below the server's."""
    base = st.get_option("server.baseUrlPath").strip("/")
    root = f"/{base}" if base else ""
    shell = (files("streamlit") / "static" / "index.html").read_text(encoding="utf-8")
    told = shell.replace(HEAD, HEAD + WHERE, 1)

    def answer(_: Request) -> HTMLResponse:
        return HTMLResponse(told, headers={"Cache-Control": "no-cache"})

    return [Route(f"{root}/{page.stem}", answer) for page in sorted(pages.glob("*.py"))]
