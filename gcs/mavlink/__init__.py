"""MAVLink on the ground's side: codec, clocks, links to vehicles, set-points out and telemetry in."""
