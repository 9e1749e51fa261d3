"""Many people on one server: visitors without browsers, each with a day of their own."""
