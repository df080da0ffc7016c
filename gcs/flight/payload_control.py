"""The payload under control, from spool-up to the end of spool-down: what it follows, and its control step."""

import math
from collections.abc import Sequence

import numpy as np

from gcs.config.flight_settings import TakeoffLandingSettings
from gcs.flight.condition import System
from gcs.flight.control_loop import ControlLoop, Setpoints, StepRecord
from gcs.flight.flown_mission import FlownMission
from gcs.flight.spool import Footing, SpoolUp, Touchdown
from idc_controller.arrays import Array
from idc_controller.estimation.grounded_links import LinkStates
from idc_controller.estimation.measurements import Estimate, Measurement
from idc_controller.estimation.settings import LiftOffSettings
from idc_controller.trajectory.flatness import Reference
from idc_controller.trajectory.trajectory import RestTrajectory, Trajectory


class PayloadControl:
    """The payload on its pad, on its trajectory, and where it has touched down. Times are the team's (s).

    A control step in three parts, so that what is estimated can end it: :meth:`has_lifted_off`, :meth:`estimate`,
    :meth:`control`.
    """

    def __init__(
        self,
        control: ControlLoop,
        system: System,
        flown: FlownMission,
        settings: TakeoffLandingSettings,
        lift_off: LiftOffSettings,
    ) -> None:
        self._loop, self._system, self._flown = control, system, flown
        self._settings, self._lift_off = settings, lift_off
        self.pad: Trajectory | None = None
        """Rest where the payload stands before the take-off; None before the check that finds the place."""
        self._spool_up: SpoolUp | None = None
        """None once the payload has lifted off."""
        self._touchdown: Touchdown | None = None
        """None until the payload has touched down, and again from the next spool-up on."""

    def reference(self, times: Array) -> tuple[Array, Array]:
        """Return the mission's position and velocity (K, 3) of the payload at ``times`` since take-off began."""
        if self._flown.trajectory is not None:
            return self._flown.reference(times)
        assert self.pad is not None
        position, velocity = self.pad.derivatives(times, 1)
        return position, velocity

    def add(self, measurements: Sequence[Measurement]) -> Sequence[Measurement]:
        """Take telemetry of the vehicles and of the payload unit; return what is used of it."""
        estimator = self._loop.estimator
        for taken in measurements:
            self._system.plan.add(taken)
            if self._spool_up is not None:
                self._spool_up.detector.add(taken)
        used = [used for taken in measurements if (used := estimator.add(taken)) is not None]
        for taken in used:
            if self._flown.in_air:
                self._loop.links.locate(taken)
            else:
                self._loop.add_to_links(taken)
        return used

    # Take-off

    def start(self, time: float) -> None:
        """Spool up, from rest on the pad."""
        assert self.pad is not None
        loop = self._loop
        controller = loop.controller
        if self._touchdown is not None:  # of the flight before
            self._touchdown = None
            controller.start()
        load = controller.load.estimate
        rest = Reference(controller.parameters, self.pad, load).at(np.array([time])).x[0]
        loop.estimator.start(time, rest, load)
        loop.estimator.setpoints.add(time, None)
        loop.start_links(time, rest[:12])
        self._spool_up = SpoolUp(loop, time, self._settings, self._lift_off)

    def in_cradles(self, time: float) -> bool:
        """Return whether the rotors, which spool up, do not lift a vehicle's own weight yet."""
        if self._spool_up is None:
            return False
        p, share = self._loop.controller.parameters, self._spool_up.share(time)
        return bool(np.all(share * p.hover_thrust < p.m * p.g))

    def is_spooled_up(self, time: float) -> bool:
        """Return whether the thrust carries the expected payload."""
        return self._spool_up is not None and self._spool_up.share(time) >= 1.0

    def has_lifted_off(self, time: float) -> bool:
        """Return whether the payload lifts off in this control step; if so, its mass is taken."""
        if self._spool_up is None or not self._spool_up.has_lifted_off(time):
            return False
        self._spool_up = None
        return True

    # Control step

    def estimate(self, time: float, effective: float) -> Estimate:
        """Return the estimate at ``effective`` (s), when the set-points of this control step act."""
        if (touchdown := self._touchdown) is not None:
            self._loop.estimator.hold_payload(time, touchdown.trajectory.position(time), touchdown.yaw)
        estimate = self._loop.estimate(effective, self._followed)
        if self._spool_up is not None and self._flown.in_air:
            self._spool_up.continue_in_climb(self._system.plan.below_plan(estimate.x[2]))
        return estimate

    def control(self, time: float, effective: float, leaves: Array, estimate: Estimate) -> tuple[Setpoints, StepRecord]:
        """Return set-points that leave at ``leaves`` (N,) (s), and the decision on the ``estimate`` of this step."""
        loop, system, in_air = self._loop, self._system, self._flown.in_air
        links = None if in_air else loop.links.at(estimate.time)
        record = loop.decide(
            estimate,
            self._followed,
            links=links,
            learn_load=system.payload.may_be_weighed(estimate),
            touched_down=self._touchdown is not None,
        )
        decision = record.decision
        thrusts = decision.thrusts if links is None else self._thrusts(time, decision.thrusts, links)
        if links is not None:
            tilts = decision.u[loop.controller.layout.n_setpoint].reshape(-1, 2)
            loop.links.command(effective, tilts, thrusts)
        setpoints = Setpoints(decision.directions, thrusts)
        # Those that would land by dead reckoning hold first: it is their thrust that keeps links upright.
        may_land = len(loop.links.unlocated) < 2
        if links is not None and may_land and not self.in_cradles(time):
            loop.stand(record, effective, links, setpoints)
        if self._spool_up is not None:
            self._spool_up.sent(effective, setpoints, leaves, in_air=in_air)
            if in_air and system.payload.is_clear(estimate):
                self._spool_up = None
        if in_air:
            horizon = loop.controller.tracker.horizon * loop.controller.settings.period
            until_landing = self._flown.until_landing(time, horizon) if may_land else math.inf
            loop.send(record, effective, leaves, system.team.hold, until_landing)
            places = loop.estimator.measurement_model.vehicles(time, decision.flat.x[0])
            contradicted = loop.estimator.health.uav_positions_isolated
            planned_down = float(decision.flat.payload[0, 0, 2])
            system.plan.compare(estimate.time, places.values[:, :3], contradicted, planned_down)
        return setpoints, record

    @property
    def _followed(self) -> Trajectory:
        if self._touchdown is not None:
            return self._touchdown.trajectory
        if self._flown.trajectory is not None:
            return self._flown.trajectory.trajectory
        assert self.pad is not None
        return self.pad

    def _thrusts(self, time: float, hover: Array, links: LinkStates) -> Array:
        """Return the thrusts (N,) (N) on the ground of UAVs that need ``hover`` (N,) with the payload in the air."""
        if self._touchdown is not None:
            return self._touchdown.thrusts(time, hover, links)
        return hover if self._spool_up is None else hover * self._spool_up.share(time)

    # Landing

    def stand(self, time: float, estimate: Estimate) -> None:
        """Rest where the payload stands, and spool down."""
        self._spool_up = None
        loop, layout = self._loop, self._loop.controller.layout
        self._touchdown = Touchdown(
            RestTrajectory(estimate.x[layout.r_0], time),
            float(estimate.x[layout.Theta][2]),
            time,
            Footing.of(
                loop.controller.parameters,
                self._system.settings,
                self._settings,
                loop.controller.settings.ground.tilt_max,
            ),
            self._settings,
        )
        loop.estimator.setpoints.add(estimate.time, None)
        loop.start_links(estimate.time, estimate.x[:12], estimate)
