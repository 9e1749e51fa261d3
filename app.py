"""The app: `streamlit run app.py`."""

import streamlit as st

from evdash.ui import page

LIVE = "pages/live.py"

page.begin()
groups = {"Learn": [st.Page(LIVE, title="Live", icon=":material/bolt:", default=True)]}
shown = st.navigation(groups, position="top")
page.go_on(LIVE)
shown.run()
