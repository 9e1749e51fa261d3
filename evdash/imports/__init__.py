"""Data of one's own on the way into a scenario: networks, prices, loads, sessions, workbooks."""
