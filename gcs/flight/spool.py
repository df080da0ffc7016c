"""The payload on the ground before and after the flight, while the thrust grows or fades."""

import math

import numpy as np

from gcs.config.flight_settings import TakeoffLandingSettings
from gcs.flight.control_loop import ControlLoop, Setpoints
from idc_controller.arrays import Array
from idc_controller.estimation.grounded_links import S_DOT, LinkStates, S
from idc_controller.estimation.lift_off import LiftOffDetector
from idc_controller.estimation.settings import LiftOffSettings
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


class Touchdown:
    """The payload at rest where it touched down, and the spool-down, which waits until leaning links are upright.

    First the ground takes the payload's weight over, all but a share of it that keeps the links taut: less where the
    payload slides or tips, more of a UAV without a position. A UAV that bears less than its own weight falls
    with its link, if that leans or its foot moves: this begins only when no link does and the payload is at rest, or
    after a timeout. Until then it is put off again where the payload moves, as one that has become lighter is lifted.
    """

    def __init__(
        self, trajectory: Trajectory, yaw: float, time: float, own_weights: Array, settings: TakeoffLandingSettings
    ) -> None:
        """``trajectory``: rest where it touched down at ``time`` (s); ``yaw`` in rad; ``own_weights`` (N,) (N)."""
        self.trajectory, self.yaw = trajectory, yaw
        self._begin, self._own, self._settings = time, own_weights, settings
        self._least = np.array([settings.carried_share, settings.carried_share_unlocated])
        self._time = time
        self._upright_at: float | None = None

    def thrusts(self, time: float, hover: Array, links: LinkStates) -> Array:
        """Return the thrusts (N,) at ``time`` (s) of UAVs that need ``hover`` (N,) (N) with the payload in the air."""
        s = self._settings
        unloading = 1.0 - (time - self._begin) / s.unload_time
        at_rest = float(np.linalg.norm(links.payload_velocity)) < s.rest_speed
        if unloading < s.carried_share and not at_rest:
            kept = math.exp(-(time - self._time) / s.slide_time)
            self._least = np.maximum(kept * self._least, s.carried_share_sliding)
        self._time = time
        # Where a UAV is that has no position, nothing but the tension of its link holds it.
        least = np.where(links.located, *self._least)
        standing = self._own + np.maximum(unloading, least) * np.maximum(hover - self._own, 0.0)
        if unloading > s.carried_share:
            return np.asarray(standing)
        late = time - self._begin >= s.upright_timeout
        if self._upright_at is None:
            lean = max(np.abs(links.x[S]).max(), s.lean_time * np.abs(links.x[S_DOT]).max())
            if late or (lean <= s.upright_lean and at_rest):
                self._upright_at = time
        elif not (late or at_rest) and np.all(links.thrust > self._own):
            self._upright_at = None
        if self._upright_at is None:
            return np.asarray(standing)
        usual = self._own + self._least[0] * np.maximum(hover - self._own, 0.0)
        faded = (time - self._upright_at) / s.spool_down_time * np.maximum(hover, self._own) / usual
        return np.asarray(standing * np.maximum(1.0 - faded, 0.0))  # all at the same time
