"""A vehicle on the wire: commands, parameters, telemetry, peers."""
