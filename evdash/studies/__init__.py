"""Many runs: what one day cannot tell."""
