"""What everything is made of: plain frozen data, and nothing that computes a day."""
