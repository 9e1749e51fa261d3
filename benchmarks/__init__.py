"""Long runs that measure and prove; each is one command."""
