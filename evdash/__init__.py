"""Hour-by-hour admission and scheduling of electric vehicles on a radial feeder."""

__version__ = "0.1.0"
