"""Control of a vehicle: the ground whose set-points fly it commands it, and while they come no other."""

import math
from collections import Counter

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.services.aircraft import Sender
from gcs.mavlink.services.answer import Answer, rejected_for_now
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoint_stream import Setpoint


class _Stream:
    """The last two set-points of one sender."""

    __slots__ = ("last", "previous_time", "time")

    def __init__(self, setpoint: Setpoint, now: float) -> None:
        self.last = setpoint
        self.time = now
        self.previous_time = float("-inf")


class ControlOwner:
    """Keeps each sender's stream of set-points apart, and passes on only those of the ground in control.

    A ground gets control by requesting OFFBOARD while its own set-points come, and keeps it until they have
    stopped for the loss time or the vehicle is disarmed and no longer in OFFBOARD.
    """

    def __init__(self, autopilot: Autopilot, settings: VehicleLinkSettings) -> None:
        self._settings = settings
        self._autopilot = autopilot
        self._streams: dict[Sender, _Stream] = {}
        self._refused: dict[Sender, tuple[str, float]] = {}
        """Why a sender's last set-point was refused, and when (s)."""
        self._owner: Sender | None = None

    def in_control(self, now: float) -> Sender | None:
        """Return the ground whose set-points fly the vehicle, None if there is none."""
        owner = self._owner
        if owner is None or not (self._autopilot.wants_setpoints or self._autopilot.armed):
            return None
        stream = self._streams.get(owner)
        return owner if stream is not None and self._is_fresh(stream.time, now) else None

    def is_stranger(self, sender: Sender, now: float) -> bool:
        """Return True if another ground is in control."""
        owner = self._owner
        return owner is not None and owner != sender and self.in_control(now) is not None

    def is_stranger_at_its_address(self, sender: Sender, now: float) -> bool:
        """Return True if another ground is in control, and is reached at the same address."""
        owner = self._owner
        return owner is not None and owner[0] == sender[0] and self.is_stranger(sender, now)

    def take(self, setpoint: Setpoint, sender: Sender, now: float) -> None:
        """Take a valid set-point, unless another ground is in control. One overtaken by a later one is dropped."""
        stream = self._streams.get(sender)
        if stream is None:
            self._forget_silent(now)
            if not self._has_room(sender):
                return
            self._streams[sender] = _Stream(setpoint, now)
        else:
            late = (stream.last.time_boot_ms - setpoint.time_boot_ms) & 0xFFFFFFFF
            if 0 < late < 1e3 * self._settings.reordering_max and self._is_fresh(stream.time, now):
                return
            stream.last = setpoint
            stream.previous_time = stream.time
            stream.time = now
        if sender == self._owner and self._autopilot.wants_setpoints:
            self._autopilot.follow(setpoint, now)

    def refuse(self, why: str, sender: Sender, now: float) -> None:
        """Keep why a set-point of a sender cannot be flown: it may request OFFBOARD on it."""
        self._refused.pop(sender, None)
        if len(self._refused) >= self._settings.setpoint_streams_max:
            del self._refused[next(iter(self._refused))]
        self._refused[sender] = why, now

    def enter_offboard(self, sender: Sender, now: float) -> Answer:
        """Enter OFFBOARD on the sender's own set-points, of which two must have come in time."""
        stream = self._streams.get(sender)
        if stream is None or not self._is_fresh(stream.time, now):
            why, refused_at = self._refused.get(sender, ("", -math.inf))
            if not self._is_fresh(refused_at, now):
                why = "no set-points from you"
            return rejected_for_now(f"OFFBOARD denied: {why}")
        if not self._is_fresh(stream.previous_time, stream.time):
            limit = self._autopilot.state.setpoint_loss_time
            return rejected_for_now(
                f"OFFBOARD denied: set-points from you are to come within {limit:g} s of each other"
            )
        answer = self._autopilot.enter_offboard(stream.last, stream.time, now)
        self._owner = sender
        return answer

    def _is_fresh(self, time: float, now: float) -> bool:
        return now - time < self._autopilot.state.setpoint_loss_time

    def _forget_silent(self, now: float) -> None:
        for sender, stream in tuple(self._streams.items()):
            if not self._is_fresh(stream.time, now):
                del self._streams[sender]

    def _has_room(self, sender: Sender) -> bool:
        """Return True if there is room for the stream of a sender, or room was made.

        One address, which may speak for many systems, gives way to another that has fewer streams.
        """
        if len(self._streams) < self._settings.setpoint_streams_max:
            return True
        of_address = Counter(address for address, _ in self._streams)
        address, most = of_address.most_common(1)[0]
        if most <= of_address[sender[0]] + 1:
            return False
        del self._streams[next(each for each in self._streams if each[0] == address and each != self._owner)]
        return True
