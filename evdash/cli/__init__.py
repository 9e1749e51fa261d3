"""The command line: run, validate, audit, export."""
