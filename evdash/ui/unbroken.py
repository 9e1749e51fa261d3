"""Parts that ask for a run of their own never cut off what a page's run has drawn.

A run's thread hands all it draws to the server's event loop, and ends. On a busy server that loop
may still have some of it to send when a part asks for its own run, by its timer or a touch. Up to
Streamlit 1.67 at least the new run takes the ended one's place, and what is left of that is thrown
away: the page stays half drawn, or as it was before the click.
"""

from dataclasses import replace

from streamlit.runtime.app_session import AppSession
from streamlit.runtime.scriptrunner import RerunData

_create = AppSession._create_scriptrunner  # Streamlit has no public place to mend it


def keep_runs_whole() -> None:
    """Have every session send what it drew; called once, before the server serves anybody."""
    AppSession._create_scriptrunner = _begin  # type: ignore[assignment, method-assign]


def _begin(session: AppSession, asked: RerunData) -> None:
    """Begin a run. Who asks for a whole one has let go of the run before, if there was any.

    So where there is one, it has ended unsent, and `asked` is a part's. A timer rings again, and
    need not be heard now. What was touched has to be: the whole page is drawn in place of the part.
    """
    if session._scriptrunner is not None:
        if asked.is_auto_rerun:
            return
        asked = replace(asked, fragment_id=None)
    _create(session, asked)
