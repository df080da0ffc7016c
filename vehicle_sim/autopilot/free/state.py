"""The state of a free vehicle's flight, and the transitions that its modes and failsafes share."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, field

from gcs.mavlink import px4
from idc_controller.rotations_float import Vector, euler_of
from vehicle_sim.autopilot.flight_state import FlightState, Orbit, PositionTarget
from vehicle_sim.autopilot.free import parameters as names
from vehicle_sim.autopilot.free.auto_flight import AutoFlight, Brake, Descent, Goal, Phase
from vehicle_sim.autopilot.free.dead_reckoning import DeadReckoning
from vehicle_sim.autopilot.free.fence import Fence
from vehicle_sim.autopilot.free.mission import Mission
from vehicle_sim.autopilot.free.position_control import PositionController, Reference, SpeedLimits
from vehicle_sim.autopilot.free.smooth_motion import SmoothMotion
from vehicle_sim.world.sensors import Measurement

FENCE_NOTHING, FENCE_WARNING, FENCE_HOLD, FENCE_RETURN = 0, 1, 2, 3
"""Values of GF_ACTION; any other: land."""


@dataclass(eq=False)
class FreeFlightState(FlightState):
    """What the parts of a free vehicle's autopilot share, beside what any vehicle's do."""

    home: Vector | None = None
    """Where it returns to (NED, m): where it was armed last, before that where it was first, or as commanded."""
    home_is_commanded: bool = False
    """Arming does not change it then, as in PX4."""
    armed_at: Vector | None = None
    """Where it was armed last, before that where it was first (NED, m)."""
    flight: AutoFlight | None = None
    """What it flies by itself; None: nothing, or set-points."""
    failsafe_mode: int = px4.MODE_HOLD
    """The mode that is flown in a failsafe."""
    failsafe_since: float = -math.inf
    """s"""
    mission: Mission = field(default_factory=Mission)
    take_off_altitude: float = math.nan
    """m above the ground, of the next take-off; NaN: the parameter's."""
    fence: Fence = field(default_factory=Fence)
    rally_points: tuple[Vector, ...] = ()
    """Places beside home to which it may return (NED, m)."""
    is_outside: bool = False
    """It has breached the fence, and reacted to that."""
    speed: float = math.nan
    """m/s, horizontal, as commanded; NaN: the parameter's."""
    reference: Reference | None = None
    """What the position control follows; None: nothing."""

    def __post_init__(self) -> None:
        airframe, settings = self.airframe, self.settings.free
        self.reckoning = DeadReckoning(self.navigation.arrays, airframe.g, settings)
        self.motion = SmoothMotion(settings)
        self.controller = PositionController(airframe.mass, airframe.rotors.thrust_max, airframe.g, settings)

    @property
    def estimate(self) -> Measurement | None:
        """The state to fly by, also while the position is not measured."""
        estimate = self.navigation.estimate
        return None if estimate is None else self.reckoning.corrected(estimate)

    def has_position(self, now: float) -> bool:
        """Return True if usable samples come, and the position is measured."""
        return super().has_position(now) and not self.reckoning.is_lost

    @property
    def flown_mode(self) -> int:
        """The custom mode that is flown, which in a failsafe is not the one that was commanded."""
        return self.failsafe_mode if self.failsafe else self.mode

    @property
    def is_descending(self) -> bool:
        """Return True if it descends to the ground."""
        return self.flight is not None and self.flight.is_landing

    @property
    def is_up(self) -> bool:
        """Return True if it is off the ground."""
        return self.land.in_air

    def position_target(self, now: float) -> PositionTarget | None:
        """Return what the position control follows, and where that ends; None: an attitude is flown, or nothing."""
        reference, flight = self.reference, self.flight
        if reference is None:
            return None
        end = reference.position if flight is None else flight.destination(reference.position)
        return PositionTarget(*reference, end)

    @property
    def orbit(self) -> Orbit | None:
        """The circle that is flown; None: none."""
        circle = None if self.flight is None else self.flight.circle
        return None if circle is None else Orbit(circle.centre, circle.radius)

    def breach_of(self, place: Vector) -> str | None:
        """Return how a place (NED, m; NaN: home's) breaches fence and limits about home; None: not, or no matter."""
        get = self.parameters
        if get[names.FENCE_ACTION] == FENCE_NOTHING or self.home is None:
            return None
        x, y, z = (own if math.isnan(there) else there for there, own in zip(place, self.home, strict=True))
        distance, height = math.hypot(x - self.home[0], y - self.home[1]), self.home[2] - z
        for value, limit, what in (
            (distance, names.FENCE_DISTANCE, "from home"),
            (height, names.FENCE_HEIGHT, "above home"),
        ):
            if value > get[limit] > 0.0:
                return f"{value:.0f} m {what} ({limit} {get[limit]:g} m)"
        return self.fence.breach(x, y)

    def refused_by_fence(self, place: Vector) -> str | None:
        """Return why a place (NED, m) may not be flown to; None: it may."""
        binds = self.parameters[names.FENCE_ACTION] not in (FENCE_NOTHING, FENCE_WARNING)
        return self.breach_of(place) if binds else None

    def begin_failsafe(self, mode: int, now: float, *, until_setpoints: bool = False) -> None:
        """Fly a ``mode`` that was not commanded, up to the next command or ``until_setpoints`` of OFFBOARD come."""
        self.failsafe, self.failsafe_mode, self.failsafe_since = True, mode, now
        if not until_setpoints:
            self.mode = mode

    @property
    def limits(self) -> SpeedLimits:
        """Speeds at which it flies by itself (m/s)."""
        get = self.parameters
        cruise = get[names.CRUISE_SPEED] if math.isnan(self.speed) else self.speed
        return SpeedLimits(min(cruise, get[names.SPEED_MAX]), get[names.CLIMB_MAX], get[names.SINK_MAX])

    @property
    def limits_of_setpoints(self) -> SpeedLimits:
        """Speeds within which it follows set-points (m/s)."""
        get = self.parameters
        return SpeedLimits(get[names.SPEED_MAX], get[names.CLIMB_MAX], get[names.SINK_MAX])

    def landing_speed(self, height: float) -> float:
        """Return the speed of a descent (m/s) at a ``height`` above the ground (m), as PX4's."""
        settings = self.settings.free
        slow, fast = self.parameters[px4.PARAM_LAND_SPEED], self.parameters[names.SINK_MAX]
        span = settings.landing_slow_from - settings.landing_slow_below
        share = min(max((height - settings.landing_slow_below) / span, 0.0), 1.0)
        return slow + share * (max(fast, slow) - slow)

    def fly(self, phases: Sequence[Phase]) -> None:
        """Fly ``phases`` from the state of the vehicle, or of the set-point that it follows already."""
        measured = self.estimate
        assert measured is not None
        if self.flight is None:
            yaw = euler_of(measured.attitude)[2]
            velocity = measured.velocity if self.land.in_air else (0.0, 0.0, 0.0)
            self.motion.start(measured.position, velocity, yaw)
            if not self.land.in_air:
                self.controller.reset()
        self.flight = AutoFlight(phases, self.settings.free)

    def hold_here(self) -> None:
        """Brake and stay."""
        self.fly([Brake(), self.goal(hold=math.inf)])

    def land_here(self) -> None:
        """Brake and descend."""
        self.fly([Brake(), Descent(self.ground)])

    def goal(
        self,
        position: Vector = (math.nan, math.nan, math.nan),
        yaw: float = math.nan,
        hold: float = 0.0,
        radius: float = math.nan,
        *,
        looks_ahead: bool = True,
        climb_speed: float = math.inf,
    ) -> Goal:
        """Return a goal; without a ``radius`` with that of the parameter."""
        if math.isnan(radius):
            radius = self.parameters[names.ACCEPTANCE_RADIUS]
        return Goal(position, radius, yaw, hold, looks_ahead, climb_speed)

    @property
    def ground(self) -> float:
        """Where the ground is taken to be (NED, m)."""
        return 0.0 if self.armed_at is None else self.armed_at[2]

    def stop(self) -> None:
        """Rotors off. The vehicle is then in HOLD."""
        super().stop()
        self.flight = None
        self.reference = None
        self.speed = self.take_off_altitude = math.nan
        self.controller.reset()
