"""What the services serve: one aircraft, be it a vehicle or the team, with its commands and its messages."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple, Protocol

from gcs.mavlink.address import Address
from gcs.mavlink.layout import Packed, PackedRun
from gcs.mavlink.services.answer import Answer

Sender = tuple[Address, int]
"""An address and the MAVLink system that speaks from it."""

Built = tuple[Packed, ...] | PackedRun
"""Messages of one kind: one, several, or none."""

MessageKey = tuple[int, int]
"""Component and message id."""


class Place(NamedTuple):
    """Latitude and longitude (deg), altitude (m above mean sea level); NaN: not given."""

    latitude: float
    longitude: float
    altitude: float


class Turn(NamedTuple):
    """A change of heading, as MAV_CMD_CONDITION_YAW commands it.

    ``angle`` (rad) from north, or from the heading if it ``is_relative``; ``rate`` (rad/s, NaN: the aircraft's own);
    ``direction`` 1 clockwise, -1 counter-clockwise, 0 the shorter way.
    """

    angle: float
    rate: float
    direction: int
    is_relative: bool


class Orbit(NamedTuple):
    """A circle about a place, as MAV_CMD_DO_ORBIT commands it; NaN: the aircraft's own.

    ``radius`` in m, negative counter-clockwise; ``speed`` in m/s; ``heading`` ORBIT_YAW_BEHAVIOUR; ``angle`` in rad,
    after which it holds, infinite: for ever; ``centre`` NaN: where it is.
    """

    radius: float
    speed: float
    heading: int
    angle: float
    centre: Place


class Reposition(NamedTuple):
    """Where MAV_CMD_DO_REPOSITION sends an aircraft; NaN: as it is now.

    Latitude and longitude in deg, ``altitude`` in m above mean sea level, ``yaw`` in rad, ``speed`` in m/s.
    """

    latitude: float
    longitude: float
    altitude: float
    yaw: float
    speed: float


class Aircraft(Protocol):
    """What an aircraft does when it is commanded; every refusal says why. Times in s."""

    @property
    def modes(self) -> Sequence[int]:
        """Return PX4's custom modes that it can enter, in the order in which they are offered."""

    @property
    def obeys_broadcasts(self) -> bool:
        """Return True if a command to all systems is for it, too."""

    def arming_problem(self, now: float) -> str | None:
        """Return why it cannot be armed now, None if it can."""

    def arm(self, now: float, force: bool = False) -> Answer:
        """Arm; ``force`` skips what checks may be skipped."""

    def disarm(self, sender: Sender, now: float, force: bool = False) -> Answer:
        """Disarm for ``sender``, in the air only with ``force``."""

    def enter_mode(self, custom_mode: int, sender: Sender, now: float) -> Answer:
        """Enter one of PX4's custom modes for ``sender``."""

    def take_off(self, altitude: float, now: float) -> Answer:
        """Take off to ``altitude`` (m above mean sea level; NaN: the parameter's height)."""

    def reposition(self, goal: Reposition, now: float) -> Answer:
        """Fly to a place and hold there."""

    def change_speed(self, speed: float, now: float) -> Answer:
        """Fly with another speed (m/s) from now on."""

    def turn(self, turn: Turn, now: float) -> Answer:
        """Change the heading where it is."""

    def orbit(self, orbit: Orbit, now: float) -> Answer:
        """Fly on a circle."""

    def set_home(self, place: Place | None, now: float) -> Answer:
        """Return to a ``place`` from now on; None: to where it is."""

    def start_mission(self, first: int, now: float) -> Answer:
        """Fly the mission from item ``first`` on."""

    def pause(self, now: float) -> Answer:
        """Hold."""

    def resume(self, now: float) -> Answer:
        """Go on with the mission that was paused."""


class Control(Protocol):
    """Who may command an aircraft."""

    def is_stranger(self, sender: Sender, now: float) -> bool:
        """Return True if another ground is in control."""

    def is_stranger_at_its_address(self, sender: Sender, now: float) -> bool:
        """Return True if another ground is in control, and is reached at the same address."""


class MessageSource(Protocol):
    """What streams are made of."""

    @property
    def builders(self) -> Mapping[MessageKey, Callable[[float], Built]]:
        """Return what builds the messages of a component and id at a time (s): none while there is no data."""

    def absence(self, key: MessageKey) -> str | None:
        """Return why a message will not be sent, whoever requests it; None: it will."""


class Sample:
    """The messages of an aircraft at ``now`` (s), each built when it is first due, once for all peers."""

    def __init__(self, source: MessageSource, now: float) -> None:
        self._builders = source.builders
        self._now = now
        self._built: dict[MessageKey, Built] = {}

    def messages(self, key: MessageKey) -> Built:
        """Return the messages of a component and message id."""
        built = self._built.get(key)
        if built is None:
            built = self._built[key] = self._builders[key](self._now)
        return built
