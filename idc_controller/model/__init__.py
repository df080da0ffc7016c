"""Models of the payload, its links and its UAVs."""
