"""The state of payload and UAVs from noisy, late and faulty telemetry."""
