"""The tables of the system file that describe what flies: payload, UAVs, team, sensors, rates, motion limits, world.

SI units; frames are north-east-down (world) and forward-right-down (payload, UAV). Masses and lengths are those of
Table I of the paper.
"""

from dataclasses import MISSING, dataclass, field

import numpy as np

from gcs.config.payload_mesh import PayloadMesh
from idc_controller.arrays import Array
from idc_controller.control.settings import CONTROL_RATE
from idc_controller.parameters import PayloadHull
from idc_controller.settings import SettingsTable, setting
from idc_controller.trajectory.settings import CORNER, Limits

Vector = tuple[float, float, float]

PAYLOAD_MASS_MIN = 0.1
"""Least mass (kg) of a payload without its cargo, whatever it has lost."""


@dataclass(frozen=True, eq=False, repr=False)
class PayloadConfig(SettingsTable):
    """The payload: a box, or the body of a mesh, from which size and inertia follow."""

    mass: float = setting(3.1, "kg", "mass in the controller's model", gt=0.0)
    inertia: Vector | None = setting(
        (0.29, 0.29, 0.55), "kg m2", "principal moments of inertia about the axes of the box", gt=0.0
    )
    size: Vector | None = setting((1.0, 1.0, 0.5), "m", "edges of the box", gt=0.0)
    mesh: PayloadMesh | None = setting(
        None, "", "STL, OBJ or PLY file of a body of one density, in place of the box; axes forward-right-down"
    )

    def __post_init__(self) -> None:
        if self.mesh is not None:
            object.__setattr__(self, "size", None)
            object.__setattr__(self, "inertia", None)

    @property
    def hull(self) -> PayloadHull:
        """Its convex hull about the centre of mass."""
        return PayloadHull.box(np.array(self.size)) if self.mesh is None else PayloadHull(self.mesh.vertices)

    @property
    def inertia_tensor(self) -> Array:
        """Its inertia about the centre of mass (3, 3) (kg m2)."""
        return np.diag(np.array(self.inertia)) if self.mesh is None else self.mass * self.mesh.inertia

    @property
    def centre_of_mass(self) -> Array:
        """The centre of mass (3,) (m) in the coordinates of the attachment points: the mesh's, or the box's."""
        return np.zeros(3) if self.mesh is None else self.mesh.centre_of_mass


@dataclass(frozen=True, eq=False, repr=False)
class Cargo(SettingsTable):
    """What one gripper of the payload holds, or can grab. Container and centre of mass are the payload's."""

    gripper: int = setting(MISSING, "", "number of the gripper, of MAV_CMD_DO_GRIPPER", ge=1, le=6)
    mass: float = setting(MISSING, "kg", "mass; payload.mass contains it if it is loaded", gt=0.0)
    loaded: bool = setting(True, "", "whether the gripper holds it at the first take-off")


DEFAULT_CARGO = Cargo(1, 0.5), Cargo(2, 0.5)
"""That of the default payload."""


@dataclass(frozen=True, eq=False, repr=False)
class UavConfig(SettingsTable):
    """One UAV; all are alike."""

    mass: float = setting(0.7, "kg", "mass", gt=0.0)
    inertia: Vector = setting((0.01, 0.01, 0.01), "kg m2", "principal moments of inertia about the body's axes", gt=0.0)
    disc_radius: float = setting(0.3, "m", "radius of the disc that covers the rotors", gt=0.0)
    arm_length: float = setting(0.17, "m", "distance from the centre to a rotor", gt=0.0)
    thrust_max: float = setting(30.0, "N", "largest thrust of the four rotors together", gt=0.0)
    motor_time_constant: float = setting(0.05, "s", "first-order lag of the rotor speed", gt=0.0)
    torque_to_thrust: float = setting(0.016, "m", "drag torque of a rotor over its thrust", gt=0.0)
    rotor_speed_max: float = setting(1000.0, "rad/s", "largest rotor speed", gt=0.0)
    attitude_kp: float = setting(100.0, "1/s2", "proportional gain of the onboard attitude loop", gt=0.0)
    attitude_kd: float = setting(16.0, "1/s", "derivative gain of the onboard attitude loop", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class TeamConfig(SettingsTable):
    """The number of UAVs, and the attachment of their links to the payload."""

    vehicles: int = setting(4, "", "number of UAVs; vehicle-sim simulates up to 15", ge=3, le=99)
    spacing: float = setting(
        1.0, "m", "distance between neighbouring attachment points: the side of their regular polygon", gt=0.0
    )
    link_length: float = setting(3.2, "m", "length of a link", gt=0.0)
    attachments: tuple[Vector, ...] | None = setting(
        None,
        "m",
        "one attachment point a UAV in place of the polygon: from the centre of the box, or in the mesh's coordinates",
    )


@dataclass(frozen=True, eq=False, repr=False)
class SensorsConfig(SettingsTable):
    """Navigation sensors: standard deviations of the white noise on every axis; 0 switches a noise off."""

    position: float = setting(0.02, "m", "position of payload and UAVs", ge=0.0)
    attitude_deg: float = setting(0.2, "deg", "attitude of payload and UAVs", ge=0.0)
    uav_velocity: float = setting(0.02, "m/s", "velocity of a UAV", ge=0.0)
    uav_rates: float = setting(0.005, "rad/s", "body rates of a UAV", ge=0.0)
    payload_velocity: float = setting(0.008, "m/s", "velocity of the payload", ge=0.0)
    payload_rates: float = setting(0.008, "rad/s", "body rates of the payload", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class RangeSensorConfig(SettingsTable):
    """The range sensor of every vehicle, for obstacles: a lidar with a known pattern of rays, to all sides.

    The default field of view is part of what two hemispherical lidars see (RoboSense Airy: 90 deg from top to bottom,
    each): down to obstacles beside the payload, 3.7 m below, that are 1.3 m away, up to what is higher than the team
    where it flies to. Such lidars measure 10^5 to 10^6 rays a second; the default is a fifth of the least, as a
    telemetry link does not carry them all.
    """

    range: float = setting(10.0, "m", "largest distance at which an obstacle is detected", gt=0.0)
    rate: int = setting(10, "Hz", "scans; divides rates.physics", gt=0, le=1_000_000)
    noise: float = setting(0.05, "m", "standard deviation along the line of sight", ge=0.0)
    range_min: float = setting(
        0.05, "m", "distance below which nothing is measured; a ray that ends there looks free", ge=0.0
    )
    rays: int = setting(2000, "", "rays of one scan, evenly over the field of view", ge=1, le=20_000)
    elevation_min_deg: float = setting(
        -70.0, "deg", "lower end of the field of view, upwards from the vehicle's horizontal plane", ge=-90.0, lt=90.0
    )
    elevation_max_deg: float = setting(30.0, "deg", "upper end of the field of view", gt=-90.0, le=90.0)
    missed_share: float = setting(0.02, "", "share of the rays that return nothing though they hit", ge=0.0, lt=1.0)
    ground_height: float = setting(
        0.3,
        "m",
        "height above the ground, by its own pose, up to which a vehicle takes a return for the ground",
        ge=0.0,
    )


@dataclass(frozen=True, eq=False, repr=False)
class RatesConfig(SettingsTable):
    """Rates; each divides that of the physics."""

    physics: int = setting(500, "Hz", "steps of the simulated world", ge=500, le=100_000)
    onboard: int = setting(250, "Hz", "attitude and rate loops on the vehicles", gt=0, le=1_000_000)
    telemetry: int = setting(
        25, "Hz", "telemetry of each vehicle, and of the payload unit that it relays", gt=0, le=1_000_000
    )
    control: int = setting(CONTROL_RATE, "Hz", "set-points from the ground", gt=0, le=1_000_000)
    truth: int = setting(50, "Hz", "rows of truth.csv, at least", gt=0, le=500)


@dataclass(frozen=True, eq=False, repr=False)
class MotionConfig(SettingsTable):
    """Limits of the payload's trajectories."""

    speed: float = setting(Limits.speed, "m/s", "speed where a mission names none", gt=0.0)
    speed_max: float = setting(3.0, "m/s", "speed to which a mission's is capped", gt=0.0)
    acceleration: float = setting(Limits.acceleration, "m/s2", "acceleration between waypoints", gt=0.0)
    jerk: float = setting(Limits.jerk, "m/s3", "jerk between waypoints", gt=0.0)
    snap: float = setting(Limits.snap, "m/s4", "snap between waypoints", gt=0.0)
    crackle: float = setting(
        Limits.crackle, "m/s5", "crackle between waypoints: the UAVs' tilt set-points jump where it does", gt=0.0
    )
    corner: float = setting(CORNER, "m", "distance within which a waypoint without hold is passed", gt=0.0)
    climb_speed: float = setting(1.0, "m/s", "vertical speed of take-off and descent", gt=0.0)
    climb_crackle: float = setting(
        60.0, "m/s5", "crackle of climb and landing: they tilt no UAV, and a slow touch-down bounces", gt=0.0
    )
    landing_speed: float = setting(0.3, "m/s", "vertical speed at touch-down", gt=0.0)
    curve_speed: float = setting(5.0, "m/s", "speed on figure eights, which turn all the time", gt=0.0)
    curve_acceleration: float = setting(3.5, "m/s2", "acceleration on figure eights", gt=0.0)
    curve_jerk: float = setting(5.0, "m/s3", "jerk on figure eights", gt=0.0)
    curve_snap: float = setting(8.0, "m/s4", "snap on figure eights", gt=0.0)

    @property
    def limits(self) -> Limits:
        """The limits of the motion between waypoints, at the speed where a mission names none."""
        return Limits(self.speed, self.acceleration, self.jerk, self.snap, self.crackle)

    @property
    def climb_limits(self) -> Limits:
        """The limits of climb and landing."""
        return Limits(self.climb_speed, self.acceleration, self.jerk, self.snap, self.climb_crackle)

    @property
    def curve_limits(self) -> Limits:
        """The limits of the motion along a curve."""
        return Limits(self.curve_speed, self.curve_acceleration, self.curve_jerk, self.curve_snap)


@dataclass(frozen=True, eq=False, repr=False)
class PadSettings(SettingsTable):
    """The pad on which the payload stands before take-off."""

    thickness: float = setting(0.05, "m", "height of the pad above the ground", gt=0.0)
    margin: float = setting(0.25, "m", "by which the pad is larger than the payload on every side", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class CradleSettings(SettingsTable):
    """Cradles that keep the UAVs on top of their links on the ground."""

    release_factor: float = setting(
        1.05, "", "of the UAV's weight: upward thrust that opens its cradle; it closes below the weight", ge=1.0
    )
    latch_speed: float = setting(0.3, "m/s", "speed above which a cradle does not close", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class AirSettings(SettingsTable):
    """Drag in wind, quadratic in the velocity of the air against a body."""

    density: float = setting(1.225, "kg/m3", "density of the air", ge=0.0)
    payload_drag: float = setting(1.05, "", "drag coefficient of the payload: of a box", ge=0.0)
    uav_drag_area: float = setting(0.03, "m2", "drag coefficient times area of a UAV: a quadrotor of 0.7 kg", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class BodySettings(SettingsTable):
    """Bodies of the system as they meet others and the ground; links have no friction."""

    friction: float = setting(0.8, "", "coefficient of friction of payload and UAVs", ge=0.0)
    link_radius: float = setting(0.01, "m", "radius of the links", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class RestSettings(SettingsTable):
    """What counts as rest at the end, when all are disarmed."""

    speed: float = setting(0.1, "m/s", "speed below which payload and UAVs are at rest", gt=0.0)
    thrust: float = setting(0.1, "N", "thrust of a UAV up to which its rotors have run down", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class WorldConfig(SettingsTable):
    """The simulated world, and its difference from the controller's model."""

    payload_mass_factor: float = setting(1.0, "", "true payload mass over payload.mass", gt=0.0)
    pad: PadSettings = field(default_factory=PadSettings)
    cradles: CradleSettings = field(default_factory=CradleSettings)
    bodies: BodySettings = field(default_factory=BodySettings)
    rest: RestSettings = field(default_factory=RestSettings)
    air: AirSettings = field(default_factory=AirSettings)
