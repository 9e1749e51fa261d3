"""The app: `streamlit run app.py`.

Streamlit's server imports this file once, for `app`, and runs it for every visitor as `__main__`.
"""

from pathlib import Path

import streamlit as st

if __name__ == "__main__":
    from evdash.ui import entry, look

    LEARN = [
        st.Page("pages/live.py", title="Live", icon=":material/bolt:", default=True),
        st.Page("pages/vehicles.py", title="Vehicles", icon=":material/directions_car:"),
        st.Page("pages/feeder.py", title="Feeder", icon=":material/account_tree:"),
        st.Page("pages/model.py", title="Model", icon=":material/function:"),
    ]
    PLAN = [
        st.Page("pages/scenario.py", title="Scenario", icon=":material/tune:"),
        st.Page("pages/compare.py", title="Compare", icon=":material/compare_arrows:"),
        st.Page("pages/studies.py", title="Studies", icon=":material/query_stats:"),
    ]

    look.begin()
    entry.ask_to_sign_in([*LEARN, *PLAN])
    with look.while_fetching():
        from evdash.ui import page, widths
        from evdash.ui.session import current

    with page.drawing():
        page.begin()
        shown = page.navigation({"Learn": LEARN, "Plan": PLAN})
        page.go_on("pages/live.py")
        shown.run()
    page.settle_in()
    page.keep_address()
    widths.listen(current())
    entry.say_who_is_signed_in()
else:
    from evdash.ui import deep_links, gate, own_pages, unbroken

    unbroken.keep_runs_whole()
    app = st.App(
        __file__,
        routes=deep_links.routes(Path(__file__).with_name("pages")),
        middleware=[*own_pages.MIDDLEWARE, *gate.MIDDLEWARE],
        lifespan=own_pages.say_where,
    )
