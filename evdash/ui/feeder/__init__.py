"""The pieces of the Feeder page."""
