"""What a vehicle streams at one moment, built once for all its peers."""

from vehicle_sim.mavlink.telemetry import Built, Telemetry


class TelemetrySample:
    """The messages of one vehicle at ``now`` (s), each built when it is first due, once for all peers."""

    def __init__(self, telemetry: Telemetry, now: float) -> None:
        self._builders = telemetry.builders
        self._now = now
        self._built: dict[tuple[int, int], Built] = {}

    def messages(self, key: tuple[int, int]) -> Built:
        """Return the messages of a component and message id."""
        built = self._built.get(key)
        if built is None:
            built = self._built[key] = self._builders[key](self._now)
        return built
