"""Pictures of a day: pure functions from a trace to figures."""
