"""Cases prepared for a lecture: what to press is done, and what to see worked out, by the app."""
