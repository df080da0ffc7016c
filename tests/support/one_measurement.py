"""The measurement in a message on its own."""

from gcs.mavlink.telemetry import measurements


def measurement(received, uav, time):
    """Return the measurement in a message of UAV ``uav`` (0 .. N-1), true at ``time`` (s); None: there is none."""
    found, _ = measurements([(received, uav, time)])
    return found[0] if found else None
