"""Networks in pandapower's form: what is read of them, and the radial feeder they become."""
