"""Who may enter: everyone, or, where the server's secrets set up a sign-in, who has signed in."""

from collections.abc import Sequence
from pathlib import Path

import streamlit as st
from streamlit.errors import StreamlitAuthError, StreamlitSecretNotFoundError
from streamlit.navigation.page import Page

from evdash.ui.words import plain

SIGN_IN, SIGN_OUT = "Sign in", "Sign out"


def ask_to_sign_in(pages: Sequence[Page]) -> None:
    """End the page here, whichever of `pages` it is, for who has yet to sign in.

    Nothing where no sign-in is set up; `[auth]` in `.streamlit/secrets.toml` does (docs/deploy.md).
    """
    if not _is_set_up() or st.user.get("is_logged_in", False):
        return
    came_by_link = len(st.query_params) > 0
    st.navigation(pages, position="hidden")
    with st.container(key="entry", width=420):
        st.title("evdash")
        st.write("Which electric vehicles can this charging station take on, hour by hour?")
        st.write("This server asks who you are before it shows anything.")
        if st.button(
            SIGN_IN,
            key="sign_in",
            type="primary",
            icon=":material/login:",
            help="Goes to the sign-in page of whoever runs this server, and comes back here.",
        ):
            begin_sign_in()
        if came_by_link:
            st.caption("You came by a link. Open it once more when you have signed in.")
    st.stop()


def _is_set_up() -> bool:
    """Whether the secrets have a section `auth`, be it right or not.

    A file of secrets that cannot be read may have one, so nobody enters.
    """
    try:
        return "auth" in st.secrets
    except StreamlitSecretNotFoundError:
        if any(Path(file).exists() for file in st.get_option("secrets.files")):
            st.error("The server's secrets cannot be read; its log says where and why.")
            st.stop()
        return False


def begin_sign_in() -> None:
    """Go to the provider's page, or say what is wrong with how the sign-in is set up."""
    try:
        st.login()
    except StreamlitAuthError as error:
        st.error(f"The sign-in is not set up as it should be: {plain(str(error))}")


def say_who_is_signed_in() -> None:
    """At the foot of every page, with the way out; nothing where no sign-in is set up."""
    if not st.user.get("is_logged_in", False):
        return
    who = st.user.get("email") or st.user.get("name") or "somebody without a name"
    with st.container(key="signed_in", horizontal=True, vertical_alignment="center"):
        st.text(f"Signed in as {who}")
        st.button(
            SIGN_OUT,
            key="sign_out",
            icon=":material/logout:",
            on_click=st.logout,
            help="Runs are kept; their links open them again after the next sign-in.",
        )
