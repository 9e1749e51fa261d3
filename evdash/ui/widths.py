"""How wide charts are on the screen, told by the browser.

A chart comes into the page before its width is known, is drawn for any width, and drawn again
for the right one. A figure that brings the width of its predecessor is drawn once.
"""

from collections.abc import Mapping

import streamlit as st

from evdash.ui.apart import apart
from evdash.ui.session import Session

WIDEST_PX = 10_000
# Reads what plotly holds of itself; nothing is measured and nothing sent unless it changed.
# It is called at every run of the page, and told to clear away only when it goes: so what it
# holds hangs on its element, and there is one clock and not one more at every step.
SCRIPT = """
export default function ({ parentElement, setStateValue }) {
  const held = (parentElement.evdash ??= { told: "" });
  held.send = setStateValue;
  const tell = () => {
    const widths = {};
    for (const chart of document.querySelectorAll(".js-plotly-plot")) {
      const key = /st-key-(chart_\\w+)/.exec(chart.closest('[class*="st-key-chart_"]')?.className);
      if (key && chart.layout?.width) { widths[key[1]] = chart.layout.width; }
    }
    const now = JSON.stringify(widths);
    if (now !== held.told && now !== "{}") { held.told = now; held.send("widths", widths); }
  };
  held.watch ??= setInterval(tell, 700);
  return () => { clearInterval(held.watch); held.watch = null; };
}
"""
_component = st.components.v2.component("evdash_widths", js=SCRIPT)


def listen(session: Session) -> None:
    """Learn how wide the charts are; what is drawn already stays as it is."""
    apart(_listen)(session)


def _listen(session: Session) -> None:
    told = _component(key="widths", on_widths_change=lambda: None)
    session.width_px |= sound(told.widths)


def sound(told: object) -> dict[str, float]:
    """Of what a browser told, what can be widths of charts."""
    if not isinstance(told, Mapping):
        return {}
    return {
        f"{key}": float(width)
        for key, width in told.items()
        if isinstance(width, int | float) and 0 < width < WIDEST_PX
    }
