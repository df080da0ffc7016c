"""Control of a vehicle: the ground whose set-points fly it commands it, and while they come no other."""

import math
from collections import Counter, deque

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.services.aircraft import Sender
from gcs.mavlink.services.answer import ACCEPTED, Answer, rejected_for_now
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoint_stream import Setpoint

_KEPT = 500
"""Set-points that a stream remembers, to detect repeats: of 10 s at 50 Hz."""
_COPIES = 0.1
"""Time (s) in which copies that are sent at once arrive."""
_HALF_WRAP = 2**31  # ms
_CLOCK_DRIFT = 0.01
"""By how much a sender's clock may run slower than the vehicle's (s/s)."""


class _Stream:
    """The last set-point of one sender, and those ``seen``."""

    __slots__ = ("_least", "_least_at", "last", "older", "seen", "time")

    def __init__(self, setpoint: Setpoint, now: float) -> None:
        self.last = setpoint
        self.time = now
        self.seen = deque((setpoint,), _KEPT)
        self.older: Setpoint | None = None
        self._least, self._least_at = _since_stamp(setpoint, now), now
        """Least time (ms) from a stamp to the arrival, and when (s)."""

    def delay(self, setpoint: Setpoint, now: float) -> float:
        """Return by how much more (s) a set-point is delayed than the one of the sender that came soonest.

        Whatever clock the sender's stamps are by; without stamps none is known to be.
        """
        if setpoint.time_boot_ms == 0:
            return 0.0
        passed = _since_stamp(setpoint, now)
        more = (passed - self._least) & 0xFFFFFFFF
        drift = 1e3 * _CLOCK_DRIFT * (now - self._least_at)
        was_set_back = 0 < (self.last.time_boot_ms - setpoint.time_boot_ms) & 0xFFFFFFFF < _HALF_WRAP
        if was_set_back or more >= _HALF_WRAP or more <= drift:
            self._least, self._least_at = passed, now
            return 0.0
        return 1e-3 * (more - drift)

    def is_next(self, setpoint: Setpoint, now: float, reordering_max: float) -> bool:
        """Return whether a set-point is to be used: it is newer than all before, or the sender's clock was set back.

        That is taken from two in a row which have not been seen before, older by ``reordering_max`` (ms) or more: on a
        link that repeats, or delays, single ones come so late. Without stamps (0) the order is that of arrival. Copies
        of the newest, which a ground sends on a link that loses, count while they may have been sent with it.
        """
        stamp, before, self.older = setpoint.time_boot_ms, self.older, None
        late = (self.last.time_boot_ms - stamp) & 0xFFFFFFFF
        if late >= _HALF_WRAP or stamp == self.last.time_boot_ms == 0:
            is_next = True
        elif setpoint in self.seen:
            self.older = before if setpoint == before else None
            return setpoint == self.last and now - self.time < _COPIES
        elif 0 < late < reordering_max:
            is_next = False
        else:
            is_next = late == 0 or (before is not None and 0 < (stamp - before.time_boot_ms) & 0xFFFFFFFF < _HALF_WRAP)
            self.older = None if is_next else setpoint
        self.seen.append(setpoint)
        return is_next


def _since_stamp(setpoint: Setpoint, now: float) -> int:
    """Return the time (ms) from the stamp of a set-point to its arrival, by two clocks: only changes of it count."""
    return (round(1e3 * now) - setpoint.time_boot_ms) & 0xFFFFFFFF


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
        self._plan = 0, 0
        """Session and number of the last stop plan."""
        self._is_handed_over = False

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
        """Take a valid set-point, unless another ground is in control. Repeats and overtaken ones are dropped."""
        stream, in_time = self._streams.get(sender), True
        if stream is None:
            self._forget_silent(now)
            if not self._has_room(sender):
                return
            self._streams[sender] = _Stream(setpoint, now)
        else:
            if not stream.is_next(setpoint, now, 1e3 * self._settings.reordering_max):
                return
            is_copy = setpoint == stream.last and setpoint.time_boot_ms != 0
            in_time = not is_copy and stream.delay(setpoint, now) < self._autopilot.state.setpoint_loss_time
            stream.last = setpoint
            stream.time = now
        if sender != self._owner or not self._autopilot.wants_setpoints:
            return
        # The queue of a link that has become slow is as old as the loss: it must not end what the others go on with.
        if in_time or not self._autopilot.state.failsafe:
            self._autopilot.follow(setpoint, now)

    def refuse(self, why: str, sender: Sender, now: float) -> None:
        """Keep why a set-point of a sender cannot be flown: it may request OFFBOARD on it."""
        self._refused.pop(sender, None)
        if len(self._refused) >= self._settings.setpoint_streams_max:
            del self._refused[next(iter(self._refused))]
        self._refused[sender] = why, now

    def enter_offboard(self, sender: Sender, now: float) -> Answer:
        """Enter OFFBOARD on the sender's own set-points, of which one must have come in time, as in PX4."""
        stream = self._streams.get(sender)
        if stream is None or not self._is_fresh(stream.time, now):
            why, refused_at = self._refused.get(sender, ("", -math.inf))
            if not self._is_fresh(refused_at, now):
                why = "no set-points from you"
            return rejected_for_now(f"OFFBOARD denied: {why}")
        answer = self._autopilot.enter_offboard(stream.last, stream.time, now)
        if answer == ACCEPTED:
            self._owner, self._is_handed_over = sender, True
        return answer

    def is_new_plan(self, session: int, number: int) -> bool:
        """Return whether a stop plan of the ground in control has a higher number than the last one.

        Another session, that of a ground started anew, begins with OFFBOARD only.
        """
        last_session, last_number = self._plan
        if not (number > last_number if session == last_session else self._is_handed_over):
            return False
        self._plan, self._is_handed_over = (session, number), False
        return True

    @property
    def owner(self) -> Sender | None:
        """The ground that is in control, or was last; None before the first."""
        return self._owner

    def _is_fresh(self, time: float, now: float) -> bool:
        return now - time < self._autopilot.state.setpoint_loss_time

    def _forget_silent(self, now: float) -> None:
        for sender, stream in tuple(self._streams.items()):
            if sender != self._owner and not self._is_fresh(stream.time, now):
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
