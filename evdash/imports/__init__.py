"""Data of one's own on the way into a scenario: networks, sessions, workbooks."""
