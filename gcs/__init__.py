"""The ground: telemetry in, set-points out, and the mission in between."""
