"""The feeder: topology, linearised DistFlow, limits as named rows, AC power flow."""
