"""The payload on the ground before and after the flight, while the thrust grows or fades."""

import math
from typing import NamedTuple, Self

import numpy as np

from gcs.config.flight_settings import FailsafeSettings, TakeoffLandingSettings
from gcs.flight.control_loop import ControlLoop, Setpoints
from idc_controller.arrays import Array
from idc_controller.estimation.grounded_links import S_DOT, LinkStates, S
from idc_controller.estimation.lift_off import LiftOffDetector
from idc_controller.estimation.settings import LiftOffSettings
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.trajectory import Trajectory


class SpoolUp:
    """The thrust of a take-off, from idle until a payload of unknown mass has lifted off.

    It grows to the expected weight, where the climb begins; earlier if the payload has lifted off. While that stays on
    the ground although the climb has begun, the thrust grows on. At lift-off the weight follows from the thrust.
    """

    def __init__(
        self, control: ControlLoop, time: float, settings: TakeoffLandingSettings, lift_off: LiftOffSettings
    ) -> None:
        """``time`` (s) at which the rotors begin to spool up."""
        self._control, self._start, self._settings, self._lift_off = control, time, settings, lift_off
        self.detector = LiftOffDetector(control.controller.parameters, lift_off)
        self._expected = control.controller.load.payload_mass
        self._on_ground: list[tuple[float, Array, Array]] = []
        """Set-points before the climb: when they act (s), tilts and thrusts (3 N,), when they leave (N,) (s)."""

    def share(self, time: float) -> float:
        """Return the share of the thrust that carries the expected payload at ``time`` (s)."""
        return min((time - self._start) / self._settings.spool_up_time, 1.0)

    def continue_in_climb(self, lag: float) -> None:
        """Let the thrust grow on at its rate where the payload is behind the climb by a ``lag`` (m). Once a step."""
        if not lag > self._settings.lift_off_lag:
            return
        load = self._control.controller.load
        rate = (load.parameters.m_0 + float(load.parameters.m.sum())) / self._settings.spool_up_time
        load.take_mass(load.estimate.mass + rate * load.settings.period)

    def sent(self, effective: float, setpoints: Setpoints, leaves: Array, *, in_air: bool) -> None:
        """Take set-points that act from ``effective`` (s) on; those in the air are in the estimator's history, too."""
        directions, thrusts = setpoints
        self.detector.command(effective, -float(directions[:, 2] @ thrusts))
        if not in_air:
            self._on_ground.append((effective, np.concatenate([directions[:, :2].ravel(), thrusts]), leaves))

    def has_lifted_off(self, time: float) -> bool:
        """Return whether the payload has lifted off by ``time`` (s); if so, its mass is taken. Once a control step.

        A mass that differs by less than its uncertainty is left to the estimator, which has followed the motion.
        """
        mass = self.detector.mass(time)
        if mass is None:
            return False
        s = self._lift_off
        if abs(mass - self._expected) > s.significance * s.mass:
            load, estimator = self._control.controller.load, self._control.estimator
            load.take_mass(mass)
            thrust, speed = self.detector.motion(estimator.time, load.estimate.mass)
            hover = load.parameters.hover_thrust
            estimator.lift_off(hover * (thrust / hover.sum()), speed, load.estimate)
            for setpoints in self._on_ground:
                estimator.setpoints.add(*setpoints)
        return True


class Footing(NamedTuple):
    """What bounds the thrusts over a payload that stands, while its links must stay taut."""

    own: Array
    """Weights of the UAVs (N,) (N)."""
    taut: Array
    """Thrusts with which they surely lift more than that (N,) (N)."""
    carried: float
    """Share of the payload's weight that they may carry: friction holds the rest in the wind."""
    carried_unlocated: float
    """The same of one UAV without a position: beside one that carries the usual share it does not tip the payload."""
    slide: float
    """Way (m) by which the payload may slide, until the links lean by it."""

    @classmethod
    def of(
        cls, parameters: SystemParameters, failsafe: FailsafeSettings, settings: TakeoffLandingSettings, tilt_max: float
    ) -> Self:
        """``tilt_max``: sine of the largest tilt set-point. Masses and thrusts are known within their tolerance."""
        own = parameters.m * parameters.g
        taut = own * (1.0 + 2.0 * failsafe.parameter_tolerance) / math.sqrt(1.0 - tilt_max**2)
        carried = max(1.0 - failsafe.wind_drag / settings.friction, 0.0)
        # Two UAVs at one edge tip what remains of the payload if they lift half of it.
        unlocated = 0.5 * len(own) * settings.least_weight - carried
        return cls(
            own, taut, carried, min(max(unlocated, carried), 1.0), settings.upright_lean * float(parameters.l.min())
        )


class Touchdown:
    """The payload at rest where it touched down, and the spool-down, which waits until leaning links are upright.

    First the ground takes the payload's weight over, all but a share of it that keeps the links taut: the less, the
    farther the payload has slid, and more of a UAV without a position, which nothing else holds upright. A UAV that
    bears less than its own weight falls with its link, if that leans or its foot moves: this begins only when no link
    does and the payload is at rest, or after a timeout. Until then it is put off again where the payload moves, as one
    that has become lighter is lifted.
    """

    def __init__(
        self, trajectory: Trajectory, yaw: float, time: float, footing: Footing, settings: TakeoffLandingSettings
    ) -> None:
        """``trajectory``: rest where it touched down at ``time`` (s); ``yaw`` in rad."""
        self.trajectory, self.yaw = trajectory, yaw
        self._begin, self._footing, self._settings = time, footing, settings
        self._time, self._slid = time, 0.0
        self._upright_at: float | None = None

    def thrusts(self, time: float, hover: Array, links: LinkStates) -> Array:
        """Return the thrusts (N,) at ``time`` (s) of UAVs that need ``hover`` (N,) (N) with the payload in the air."""
        s, (own, taut, carried, carried_unlocated, slide) = self._settings, self._footing
        unloading = 1.0 - (time - self._begin) / s.unload_time
        speed = float(np.linalg.norm(links.payload_velocity))
        at_rest = speed < s.rest_speed
        if unloading < carried and not at_rest:
            self._slid += speed * (time - self._time)
        self._time = time
        stands = max(1.0 - self._slid / slide, 0.0)
        load = np.maximum(hover - own, 0.0)
        usual = np.maximum(stands * carried * load, np.minimum(taut - own, carried * load))
        pull = np.where(links.located, usual, np.maximum(stands * carried_unlocated * load, usual))
        standing = own + np.maximum(unloading * load, pull)
        if unloading > carried:
            return np.asarray(standing)
        late = time - self._begin >= s.upright_timeout
        if self._upright_at is None:
            lasting = np.where(links.located, s.lean_time, s.lean_time_unlocated)
            lean = max(np.abs(links.x[S]).max(), (lasting * np.abs(links.x[S_DOT]).max(axis=1)).max())
            if late or (lean <= s.upright_lean and at_rest):
                self._upright_at = time
        elif not (late or at_rest) and np.all(links.thrust > own):
            self._upright_at = None
        if self._upright_at is None:
            return np.asarray(standing)
        faded = (time - self._upright_at) / s.spool_down_time * np.maximum(hover, own) / (own + usual)
        return np.asarray(standing * np.maximum(1.0 - faded, 0.0))  # all at the same time
