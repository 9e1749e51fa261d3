"""Pure functions from what a trace says to Plotly figures as plain dicts."""
