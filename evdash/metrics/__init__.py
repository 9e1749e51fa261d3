"""Totals and tables of a day, read off its trace."""
