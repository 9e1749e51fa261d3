"""A run's files checked again by other means: the checker's own sums and AC power flow."""
