"""The measurement in a message on its own."""

from gcs.mavlink.telemetry import measurements


def measurement(received, source, time):
    """Return the measurement in a message of a ``source``, true at ``time`` (s); None: there is none."""
    found, _ = measurements([(received, source, time)])
    return found[0] if found else None
