"""Campaigns of telemetry faults."""
