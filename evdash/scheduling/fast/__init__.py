"""The fast exact solver: vehicle cuts, a master for u, recourse for D."""
