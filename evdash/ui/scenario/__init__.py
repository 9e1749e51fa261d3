"""The Scenario page: everything a day is made of, to edit, take in and hand out."""
