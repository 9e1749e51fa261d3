"""What the pages are made of: session state, controls, panels."""
