"""Scenario folders and run folders, in and out, with every fault told."""
