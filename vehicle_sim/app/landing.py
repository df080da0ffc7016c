"""What both drivers know about vehicles that are left alone."""

LANDING_TIME = 120.0
"""Simulated seconds that vehicles without a ground get to land."""
