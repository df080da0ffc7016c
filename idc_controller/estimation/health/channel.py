"""Names of what can be isolated: a channel of one sensor, and the sensors of one kind of a group."""

from typing import NamedTuple

from idc_controller.estimation.measurements import Measurement, Position


class Channel(NamedTuple):
    """Pose (``part`` 0) or motion (1) of one kind of measurement of one source."""

    source: int
    kind: type[Measurement]
    part: int

    @property
    def name(self) -> str:
        """position, velocity, attitude or rates."""
        return (("position", "velocity") if self.kind is Position else ("attitude", "rates"))[self.part]


class SensorGroup(NamedTuple):
    """One kind of measurement, of the payload unit or of all vehicles."""

    of_payload: bool
    kind: type[Measurement]
