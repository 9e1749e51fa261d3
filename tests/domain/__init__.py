"""Tests of evdash.domain."""
