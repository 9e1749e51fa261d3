"""What only the Live page is made of: its controls, headline, key figures, panels."""
