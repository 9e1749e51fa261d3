"""Handing a finished day on: checked in the background, then every file at a click."""
