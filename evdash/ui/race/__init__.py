"""The race on the Compare page: policies on the same day, run in a process of its own."""
