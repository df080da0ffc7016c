"""Drivers: they own the socket and the clock, and run the same ground station in real time or in lockstep."""
