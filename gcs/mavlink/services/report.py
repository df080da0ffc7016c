"""What the messages of an aircraft's status and motion are made of."""

from abc import ABC, abstractmethod

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.local_frame import LocalFrame, Motion, Origin
from idc_controller.rotations_float import Vector

CAPABILITIES: int = (
    mavlink.MAV_PROTOCOL_CAPABILITY_MAVLINK2
    | mavlink.MAV_PROTOCOL_CAPABILITY_PARAM_ENCODE_BYTEWISE
    | mavlink.MAV_PROTOCOL_CAPABILITY_COMMAND_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_INT
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE
    | mavlink.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY
)
"""Capabilities of everything that has the services of this package; :attr:`Report.capabilities` adds others."""


class Report(ABC):
    """Status and motion of an aircraft. Times are in s."""

    mav_type: int = mavlink.MAV_TYPE_QUADROTOR

    def __init__(self, system_id: int, home: Origin) -> None:
        self.system_id = system_id
        self.home = home
        """Origin of the local frame."""
        self.frame = LocalFrame(home)
        self.capabilities = CAPABILITIES
        """MAV_PROTOCOL_CAPABILITY of AUTOPILOT_VERSION."""
        self.clipping: dict[int, int] = {}
        """By component: physics steps in which its accelerometer exceeded its range."""

    @abstractmethod
    def time_boot_ms(self, time: float) -> int:
        """Return the stamp of a time."""

    def time_boot_us(self, time: float) -> int:
        """Return the stamp of a time in microseconds, a whole number of milliseconds."""
        return self.time_boot_ms(time) * 1000

    # Status

    @property
    @abstractmethod
    def armed(self) -> bool:
        """True if rotors may turn."""

    @property
    @abstractmethod
    def failsafe(self) -> bool:
        """True in a failsafe."""

    @property
    @abstractmethod
    def mode(self) -> int:
        """The custom mode that is flown."""

    @property
    @abstractmethod
    def intended_mode(self) -> int:
        """The custom mode that was commanded."""

    @property
    @abstractmethod
    def landed_state(self) -> int:
        """MAV_LANDED_STATE."""

    @property
    @abstractmethod
    def is_booting(self) -> bool:
        """True before the first estimate."""

    @property
    @abstractmethod
    def range_sensor_works(self) -> bool | None:
        """Whether obstacles are sensed; None: there is no range sensor."""

    @property
    @abstractmethod
    def return_position(self) -> Vector:
        """Where it returns to (NED, m)."""

    @abstractmethod
    def arming_problem(self, now: float) -> str | None:
        """Return why it cannot be armed; None: it can."""

    @abstractmethod
    def has_attitude(self, now: float) -> bool:
        """Return whether the attitude is estimated."""

    @abstractmethod
    def has_position(self, now: float) -> bool:
        """Return whether the position is estimated."""

    # Motion

    @property
    @abstractmethod
    def own_attitude(self) -> Motion | None:
        """The sample whose attitude and rates are sent."""

    @property
    @abstractmethod
    def own_position(self) -> Motion | None:
        """The sample whose position and velocity are sent."""

    @property
    @abstractmethod
    def own_state(self) -> Motion | None:
        """Both in one, for messages that need both; None without either, and for what integers cannot hold."""

    @property
    @abstractmethod
    def throttle(self) -> float:
        """Collective thrust that is commanded, 0 to 1."""

    @property
    @abstractmethod
    def specific_force(self) -> Vector | None:
        """Specific force, in the body frame (m/s2); None: it is not measured."""
