"""What a finished day is handed on as: a report, a workbook, profiles, a network, a run's files."""
