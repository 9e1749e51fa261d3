"""The pieces of the Vehicles page."""
