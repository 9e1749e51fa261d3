"""The Model page: the mathematics with the run's own numbers, and what the paper reports."""
