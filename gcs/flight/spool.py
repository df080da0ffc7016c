"""The payload on the ground before and after the flight, while the thrust grows or fades."""

from typing import NamedTuple

import numpy as np

from gcs.config.flight_settings import TakeoffLandingSettings
from gcs.flight.control_loop import ControlLoop, Setpoints
from idc_controller.arrays import Array
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


class Shares(NamedTuple):
    """Shares of the hover thrust with the payload on the ground, links upright or leaning."""

    standing: float
    leaning: float


class Touchdown:
    """The payload at rest where it touched down, and the spool-down, which waits until leaning links are upright."""

    def __init__(
        self,
        trajectory: Trajectory,
        yaw: float,
        time: float,
        settings: TakeoffLandingSettings,
        shares: Shares | None = None,
    ) -> None:
        """``trajectory``: rest since the touchdown at ``time`` (s); ``yaw`` in rad; ``shares``: None: the settings'."""
        self.trajectory, self.yaw = trajectory, yaw
        self._since, self._settings = time, settings
        self._shares = shares or Shares(settings.standing_share, settings.leaning_share)
        self._leaning, self._least = True, self._shares.standing

    def share(self, time: float, lean: float) -> float:
        """Return the share of the hover thrust at ``time`` (s).

        ``lean``: largest sine of a link's tilt by axis, now or soon.
        """
        s = self._settings
        if self._leaning:
            share = max(1.0 - (time - self._since) / s.spool_down_time, self._least)
            if share > self._shares.standing:
                return share
            if lean > s.upright_lean and time - self._since < s.upright_timeout:
                self._least = self._shares.leaning  # with more of it a payload slides in wind
                return share
            self._leaning, self._since = False, time - (1.0 - share) * s.spool_down_time
        return max(1.0 - (time - self._since) / s.spool_down_time, 0.0)


def shares_of(parameters: SystemParameters, mass: float, settings: TakeoffLandingSettings) -> Shares:
    """Return the shares for a payload of ``mass`` (kg): those of the settings are for the stated one.

    With the vehicles' weight w, the hover thrust h, and h' of the stated payload: the share s leaves the links s h' - w
    to stand upright by. Standing, that is the same share of their pull in flight, h - w; leaning, the same force up to
    that, as the vehicles' motion depends on no payload.
    """
    stated, own = float(parameters.hover_thrust.sum()), float(parameters.m.sum()) * parameters.g
    hover = stated + (mass - parameters.m_0) * parameters.g
    standing, leaning = settings.standing_share, settings.leaning_share
    standing += (1.0 - standing) * own * (stated - hover) / (hover * (stated - own))
    return Shares(standing, min(leaning + leaning * (stated - hover) / hover, standing))
