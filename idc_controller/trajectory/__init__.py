"""Trajectories of the payload, and the flat reference that follows from them."""
