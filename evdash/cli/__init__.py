"""The command line: run, validate, audit."""
