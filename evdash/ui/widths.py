"""How wide charts are on the screen, told by the browser.

A chart comes into the page before its width is known, is drawn for any width, and drawn again
for the right one. A figure that brings the width of its predecessor is drawn once.
"""

import time
from collections.abc import Mapping

import streamlit as st

from evdash.ui.apart import apart
from evdash.ui.session import Session

WIDEST_PX = 10_000
# Reads what plotly holds of itself; nothing is measured, and nothing sent that the server knows.
# What it holds hangs on its element, so that there is one clock and not one more at every step.
#
# What it sends must never meet what a person asks for. If both come in the same moment, Streamlit
# 1.67 sends them as one message, of this part alone, and the click is lost; after a click on
# another page's name it brings the server back to the page that was left, and neither is whole.
# So nothing is sent from a person's touch until the page has been drawn for it, and a click that
# comes before what was told is on its way waits for that.
SCRIPT = """
const REST_MS = 600;
const ON_ITS_WAY_MS = 50;
const TOUCHES = ["pointerdown", "keydown", "input", "click", "popstate"];
function listening() {
  const tab = { isAsked: false, touchedAt: -REST_MS, isTelling: false };
  const touch = (event) => {
    tab.isAsked = true;
    tab.touchedAt = performance.now();
    if (tab.isTelling && event.type === "click") {
      event.stopImmediatePropagation();
      event.preventDefault();
      const again = new MouseEvent("click", event);
      setTimeout(() => event.target.dispatchEvent(again), ON_ITS_WAY_MS);
    }
  };
  TOUCHES.forEach((kind) => window.addEventListener(kind, touch, { capture: true }));
  return tab;
}
function isAtRest(tab) {
  const app = document.querySelector("[data-testid=stApp]");
  const isDrawn = app?.dataset.testScriptState === "notRunning";
  return isDrawn && !tab.isAsked && performance.now() - tab.touchedAt > REST_MS;
}
function changes(known) {
  const found = {};
  for (const chart of document.querySelectorAll(".js-plotly-plot")) {
    const key = /st-key-(chart_\\w+)/.exec(chart.closest('[class*="st-key-chart_"]')?.className);
    const width = chart.layout?.width;
    if (key && width && known[key[1]] !== width) { found[key[1]] = width; }
  }
  return found;
}
export default function ({ parentElement, setStateValue, data }) {
  const tab = (window.evdashTab ??= listening());
  const held = (parentElement.evdash ??= {});
  if (held.run !== data.run) { tab.isAsked = false; }
  Object.assign(held, { run: data.run, known: { ...data.known }, send: setStateValue });
  const tell = () => {
    const found = isAtRest(tab) ? changes(held.known) : {};
    if (Object.keys(found).length) {
      Object.assign(held.known, found);
      tab.isTelling = true;
      setTimeout(() => { tab.isTelling = false; }, ON_ITS_WAY_MS);
      held.send("widths", { ...held.known });
    }
  };
  held.watch ??= setInterval(tell, 700);
  return () => { clearInterval(held.watch); held.watch = null; };
}
"""
_component = st.components.v2.component("evdash_widths", js=SCRIPT)


def listen(session: Session) -> None:
    """Learn how wide the charts are; what is drawn already stays as it is."""
    apart(_listen)(session, time.monotonic())


def _listen(session: Session, run: float) -> None:
    """`run` is another one whenever the page, and not this part alone, is drawn."""
    data = {"known": session.width_px, "run": run}
    told = _component(key="widths", data=data, on_widths_change=lambda: None)
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
