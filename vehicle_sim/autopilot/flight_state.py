"""The state of a vehicle's flight, and the transitions that modes, failsafes and arming share."""

import math
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from gcs.config.vehicle_settings import AutopilotSettings
from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import ParameterTable
from gcs.mavlink.stop_plan import LAG_MAX
from gcs.mavlink.team_failsafe import TeamState
from idc_controller.rotations_float import Vector, euler_of
from vehicle_sim.autopilot.actuation import Actuation
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.hold_control import HoldController, HoldPlan, displacement, on_bezier_curve
from vehicle_sim.autopilot.land_detector import LandDetector
from vehicle_sim.autopilot.navigation import Navigation
from vehicle_sim.autopilot.setpoint_stream import SetpointStream
from vehicle_sim.autopilot.setpoints import StopPlan
from vehicle_sim.world.sensors import Measurement

TIME_TOLERANCE = 1e-6  # s: sums of steps are not exact
_SETPOINT_LOSS = TeamState.OFFBOARD.timer


class PositionTarget(NamedTuple):
    """What the position control follows (NED, m, m/s, m/s2, rad, rad/s; NaN: not controlled), and where that ends."""

    position: Vector
    velocity: Vector
    acceleration: Vector
    yaw: float
    yaw_rate: float
    destination: Vector


class Orbit(NamedTuple):
    """A circle about a ``centre`` (NED, m); ``radius`` (m) negative counter-clockwise."""

    centre: Vector
    radius: float


@dataclass(eq=False)
class FlightState:
    """The state that all parts of the autopilot share: parts with a state of their own, and that of the flight.

    One class, since every transition of mode, failsafe and arming reads and writes across it.
    """

    airframe: Airframe
    parameters: ParameterTable
    settings: AutopilotSettings
    navigation: Navigation
    land: LandDetector
    actuation: Actuation
    setpoints: SetpointStream
    mode: int = px4.MODE_HOLD
    """The custom mode that was commanded."""
    armed: bool = False
    failsafe: bool = False
    """The vehicle flies otherwise than commanded."""
    hold: HoldController | None = None
    """Controller of the stop, hold and descent in progress; None: there is none."""
    stop_plan: StopPlan | None = None
    """The newest of the ground in control."""
    link_time: float = -math.inf
    """Time of the last message of the ground in control, or HEARTBEAT where that may be any ground (s)."""
    specific_force: Vector | None = None
    """Measured last, in the body frame (m/s2), within the accelerometer's range; None: it is not measured."""
    notices: list[str] = field(default_factory=list)
    """STATUSTEXTs to the operator, not sent yet."""

    @property
    def flown_mode(self) -> int:
        """The custom mode that is flown, which in a failsafe is not the one that was commanded."""
        if self.is_descending:
            return px4.MODE_LAND
        return px4.MODE_HOLD if self.failsafe else self.mode

    @property
    def team_state(self) -> TeamState:
        """State of the team in which this vehicle is."""
        if not self.armed:
            return TeamState.DISARMED
        if self.hold is not None:
            return TeamState.LAND if self.is_descending else TeamState.HOLD
        return TeamState.OFFBOARD if self.is_up else TeamState.ARMED

    def has_position(self, now: float) -> bool:
        """Return True if usable samples come, and the position is measured."""
        return self.navigation.is_valid(now)

    @property
    def now(self) -> float:
        """Time of the last step (s)."""
        return self.land.last_time

    @property
    def setpoint_loss_time(self) -> float:
        """Seconds without set-points until the vehicle brakes and holds."""
        return self.parameters[_SETPOINT_LOSS]

    def has_fresh_setpoints(self, now: float) -> bool:
        """Return True if the set-points of OFFBOARD have not stopped."""
        return now - self.setpoints.last_time < self.parameters[_SETPOINT_LOSS] - TIME_TOLERANCE

    @property
    def is_descending(self) -> bool:
        """Return True if it follows a plan to the ground."""
        return self.hold is not None and self.hold.plan.is_descending(self.now)

    def position_target(self, now: float) -> PositionTarget | None:
        """Return the planned state of a stop, hold or descent, and where it comes to hold; None: there is none."""
        if self.hold is None:
            return None
        plan = self.hold.plan
        return PositionTarget(*plan.at(now), plan.yaw, math.nan, plan.control_points[-1])

    @property
    def orbit(self) -> Orbit | None:
        """The circle that is flown; None: none."""
        return None

    @property
    def supported_thrust(self) -> float:
        """The thrust (N) of a vehicle whose payload stands: less than its own weight."""
        return self.settings.land_detector.supported_thrust * (self.airframe.mass * self.airframe.g)

    @property
    def is_up(self) -> bool:
        """Return True if it is off the ground, or upright on its link only because its rotors turn."""
        return self.land.in_air or self.actuation.thrust > self.supported_thrust

    def is_supported(self, now: float) -> bool:
        """Return True if it does not sink as it should: the payload under it may stand on the ground."""
        sinks = self.hold is not None and self.hold.plan.is_at_descent_speed(now)
        return sinks and self.land.touching

    def begin_hold(self, now: float, descent_start: float) -> None:
        """Brake and hold by the ground's stop plan, or by one of its own.

        Descend when the ground's plan has all vehicles descend; without one at ``descent_start`` (s).
        """
        measured = self.navigation.estimate
        if measured is None:
            return
        settings = self.settings.hold
        sent = self._recent_stop_plan(now)
        if sent is not None:
            descent_start = sent.descent
        descent = descent_start, self.parameters[px4.PARAM_LAND_SPEED], settings.descent_ramp, sent is not None
        plan = self._plan_of_ground(sent, measured, now, descent) or HoldPlan.to_rest(
            now, measured.position, measured.velocity, euler_of(measured.attitude)[2], settings.braking,
            max(descent_start, now), *descent[1:],
        )  # fmt: skip
        thrust, weight = self.actuation.thrust, self.airframe.mass * self.airframe.g
        if not self.land.in_air:
            self.land.lift(thrust)
        hover = self.land.hover_thrust or max(thrust, weight)
        lean = 0.0, 0.0
        if sent is not None and sent.hover_force is not None:  # those of the whole team
            north, east, down = sent.hover_force
            hover, lean = min(max(-down, weight), self.airframe.rotors.thrust_max), (-north / down, -east / down)
        offset = displacement(plan.at(now).position, measured.position) if self.navigation.is_reckoned else None
        self.hold = HoldController(plan, hover, lean, self.supported_thrust, self.airframe.g, settings, offset)

    def begin_descent(self, now: float) -> None:
        """Descend from where it is, or when the other vehicles do, where that is known; on the ground stop."""
        if not self.land.in_air:
            self.stop()
            return
        if self.hold is None:
            self.begin_hold(now, descent_start=now)
        elif not (self.is_descending or self.hold.plan.is_common):
            self.hold.plan = replace(self.hold.plan, descent_start=now)
        self.mode = px4.MODE_LAND
        self.failsafe = False

    def stop(self) -> None:
        """Rotors off. The vehicle is then in HOLD, and any ground may begin anew."""
        self.armed = False
        self.failsafe = False
        self.hold = None
        self.setpoints.clear()
        self.stop_plan = None
        self.actuation.stop(self.now)
        self.mode = px4.MODE_HOLD
        self.land.start()

    def begins_on_path(self, plan: StopPlan, now: float) -> bool:
        """Return True if a stop plan begins where the vehicle will be then, or leads to where it is.

        By dead reckoning it does not know where it is: the message names the vehicle that the plan is for.
        """
        measured = self.navigation.estimate
        if measured is None or self.navigation.is_reckoned:
            return measured is not None
        time = max(now, plan.start)
        x, y, z = (r + (time - now) * v for r, v in zip(measured.position, measured.velocity, strict=True))
        share = min((time - plan.start) / plan.duration, 1.0)
        planned = on_bezier_curve([*zip(*plan.control_points, strict=True)], share) if share else plan.control_points[0]
        return math.dist(planned, (x, y, z)) <= self.settings.failsafe.stop_plan_offset

    def _recent_stop_plan(self, now: float) -> StopPlan | None:
        sent = self.stop_plan
        if sent is None:
            return None
        loss = self.setpoint_loss_time
        oldest = (1.0 + LAG_MAX) * loss + self.settings.failsafe.stop_plan_age
        return sent if -loss <= now - sent.start <= oldest else None

    def _plan_of_ground(
        self, sent: StopPlan | None, measured: Measurement, now: float, descent: tuple[float, float, float, bool]
    ) -> HoldPlan | None:
        """The ground's stop plan with a ``descent`` (start, speed, ramp, whether of all), if it is near."""
        if sent is None:
            return None
        plan = HoldPlan(sent.start, sent.duration, sent.control_points, sent.yaw, *descent)
        if self.navigation.is_reckoned:
            return plan
        near = self.settings.failsafe.stop_plan_distance
        return plan if math.dist(plan.at(now).position, measured.position) <= near else None
