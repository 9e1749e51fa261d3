"""The app: `streamlit run app.py`."""

import streamlit as st

from evdash.ui.page import begin

begin()
pages = {"Learn": [st.Page("pages/live.py", title="Live", icon=":material/bolt:", default=True)]}
st.navigation(pages, position="top").run()
