"""All vehicles descend together, whatever is lost first and second, and whenever: ground and vehicles, without physics.

The ground's choice of stop plans and the vehicles' autopilots are real; links of one step each way, and vehicles that
hover in their places, are not.
"""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from flying import AIRFRAME
from onboard import step_alone

from gcs.config.flight_settings import DEFAULTS
from gcs.config.vehicle_settings import AutopilotSettings, VehicleFailsafeSettings
from gcs.flight import control_loop
from gcs.flight.compute_times import ComputeTimes
from gcs.flight.control_loop import ControlLoop, Hold
from gcs.mavlink import px4
from gcs.mavlink.stop_plan import LAG_MAX
from idc_controller.estimation.setpoint_history import SetpointHistory
from idc_controller.trajectory.stop_plan import StopPlan as TeamPlan
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint, StopPlan
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters
from vehicle_sim.world.sensors import Measurement

N, STEP = 4, 0.02
LINK = 1
"""Steps that a message takes each way."""
LOSS, LAND_DELAY = DEFAULTS.failsafe.telemetry_timeout, 5.0
CLOCK_ERRORS = (0.0, 0.003, -0.002, 0.001)
"""Of the ground's estimates of the vehicles' clocks (s)."""
BOUND = (2 * LINK + 1) * STEP + max(CLOCK_ERRORS) - min(CLOCK_ERRORS) + 1e-9
"""A round trip of the links, a step, and what clocks differ by."""
FIRST = 10
"""Step of the first loss."""
COMMANDS, TELEMETRY, BOTH, GROUND = "commands", "telemetry", "both", "ground"


class Team:
    """A ground and its vehicles; ``losses``: (what, of which vehicle, from which step on).

    ``loss``: COM_OF_LOSS_T (s).
    """

    def __init__(self, losses, loss=LOSS):
        self.loss = loss
        self.losses, self.step, self.flying, self.landing_at = losses, 0, True, None
        self.down, self.up = [], []
        self.heard, self.offboard = [0] * N, [True] * N
        self.descends = [None] * N
        estimator = SimpleNamespace(setpoints=SetpointHistory(N))
        controller = SimpleNamespace(parameters=None, hover_forces=lambda time: np.tile([0.0, 0.0, -10.0], (N, 1)))
        self.ground = ControlLoop(estimator, controller, ComputeTimes(lambda: 0.0), None)
        settings = replace(AutopilotSettings(), failsafe=replace(VehicleFailsafeSettings(), setpoint_loss=loss))
        self.pilots = [Autopilot(AIRFRAME, vehicle_parameters(AIRFRAME, 1 + i, 250, settings)) for i in range(N)]
        for i, pilot in enumerate(self.pilots):
            self.sense(i)
            pilot.enter_offboard(self.setpoint(0), 0.0, 0.0)
            assert pilot.arm(0.0, force=True).text == ""
            pilot.state.land.lift(AIRFRAME.mass * AIRFRAME.g)

    @property
    def now(self):
        return self.step * STEP

    def sense(self, i):
        place = 0.0, float(i), -5.0
        step_alone(self.pilots[i], Measurement(self.now, (1, 0, 0, 0), (0, 0, 0), place, (0, 0, 0)), self.now)

    @staticmethod
    def setpoint(step):
        return AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.3, step)

    def is_lost(self, *what, vehicle=None):
        return any(
            loss in what and i in (None, vehicle) and step is not None and self.step >= step
            for loss, i, step in self.losses
        )

    def send(self, kind, content):
        for i in range(N):
            if not self.is_lost(COMMANDS, BOTH, vehicle=i):
                self.down.append((self.step + LINK, i, kind, content))

    def fly_ground(self):
        for at, i, flown in [report for report in self.up if report[0] == self.step]:
            self.heard[i], self.offboard[i] = at, flown is not None
            if flown is not None:
                reported = [0.001 * flown, 0.0, 10.0]
                self.ground.estimator.setpoints.confirm(i, self.now - STEP, self.now, reported, 0.0)
        silent = [(self.step - heard) * STEP for heard in self.heard]
        if self.flying and (max(silent) > self.loss or not all(self.offboard)):
            self.flying, self.landing_at = False, self.step + round(LAND_DELAY / STEP)
            self.send("plan", self.ground.stop_plan)
            self.send("mode", px4.MODE_HOLD)
        if self.flying:
            u = np.array([0.001 * self.step, 0.0] * N + [10.0] * N)
            record = SimpleNamespace(
                decision=SimpleNamespace(u=u, flat=None), estimate=SimpleNamespace(x=None, time=self.now)
            )
            hold = Hold(self.loss + LAND_DELAY, LAG_MAX * self.loss)
            self.ground.send(record, self.now + LINK * STEP, np.full(N, self.now), hold)
            self.send("plan", self.ground.stop_plan)
            self.send("setpoint", self.step)
        elif self.step == self.landing_at:
            self.send("mode", px4.MODE_LAND)

    def fly_vehicles(self):
        for _, i, kind, content in [message for message in self.down if message[0] == self.step]:
            pilot = self.pilots[i]
            if kind == "plan" and pilot.state.has_fresh_setpoints(self.now):
                points, error = ((0.0, float(i), -5.0),) * 5, CLOCK_ERRORS[i]
                start, descent = content.start + error, content.descent + error
                pilot.take_stop_plan(StopPlan(start, descent, content.duration, points, 0.0))
            elif kind == "setpoint":
                pilot.follow(self.setpoint(content), self.now)
            elif kind == "mode":
                pilot.enter_mode(content, self.now)
        for i, pilot in enumerate(self.pilots):
            self.sense(i)
            flown = pilot.state.setpoints.at(self.now) if pilot.mode == px4.MODE_OFFBOARD else None
            if not self.is_lost(TELEMETRY, BOTH, vehicle=i):
                self.up.append((self.step + LINK, i, None if flown is None else flown.time_boot_ms))
            if self.descends[i] is None and pilot.state.is_descending:
                self.descends[i] = self.now

    def next_event(self):
        """Return the next step; of a team that holds, while nothing is sent, the one before the next event."""
        plans = [pilot.state.hold.plan for pilot in self.pilots if pilot.state.hold is not None]
        if len(plans) == N and not self.down and (not self.flying or self.is_lost(GROUND)):
            events = [self.landing_at, *(step for _, _, step in self.losses)]
            events += [int(plan.descent_start / STEP) + 2 for plan in plans if plan.descent_start < np.inf]
            later = [event for event in events if event is not None and event >= self.step]
            return max(min(later, default=0) - 1, self.step + 1)
        return self.step + 1

    def run(self):
        """Return when each vehicle began to descend (s); None: it holds."""
        while self.step < FIRST + 700 and None in self.descends:
            self.step = self.next_event()
            if not self.is_lost(GROUND):
                self.fly_ground()
            self.fly_vehicles()
            self.down = [message for message in self.down if message[0] > self.step]
            self.up = [report for report in self.up if report[0] > self.step]
        return self.descends


@pytest.fixture(autouse=True)
def hovering(monkeypatch):
    def stop_plan(parameters, flat, time, x, choose, landing):
        return TeamPlan(time, 4.0, np.zeros((N, 5, 3)))

    monkeypatch.setattr(control_loop, "stop_plan", stop_plan)


@pytest.mark.parametrize(("loss", "delays"), [
    (0.2, [*range(18), 50, 249, 250, 285, None]), (LOSS, [0, 1, 23, 24, 26, 250, None]),
])  # fmt: skip
@pytest.mark.parametrize("second", [(GROUND, None), (COMMANDS, 2), (TELEMETRY, 2), (BOTH, 2)])
@pytest.mark.parametrize("first", [COMMANDS, TELEMETRY, BOTH])
def test_all_vehicles_descend_together_whatever_is_lost_first_and_second_at_any_step(first, second, loss, delays):
    for delay in delays:
        team = Team([(first, 1, FIRST), (*second, None if delay is None else FIRST + delay)], loss)
        times = team.run()
        assert None not in times, (delay, times)
        starts = [pilot.state.hold.plan.start for pilot in team.pilots]
        assert max(starts) - min(starts) <= BOUND, (delay, starts)
        assert max(times) - min(times) <= BOUND, (delay, times)
        assert FIRST * STEP + LAND_DELAY - LOSS < min(times) < FIRST * STEP + LAND_DELAY + 2.0 * LOSS + BOUND


def test_all_vehicles_descend_together_after_the_ground_alone_is_lost():
    times = Team([(GROUND, None, FIRST)]).run()
    assert max(times) - min(times) <= STEP + max(CLOCK_ERRORS) - min(CLOCK_ERRORS)


@pytest.mark.parametrize("loss", [0.2, LOSS, 1.5, 5.0])
def test_vehicles_follow_a_stop_plan_that_waited_for_a_lost_vehicle_whatever_the_time_of_setpoint_loss(loss):
    team = Team([(TELEMETRY, 1, FIRST), (GROUND, None, FIRST + round(0.95 * loss / STEP))], loss)
    times = team.run()
    assert None not in times and max(times) - min(times) <= BOUND, times
    assert all(pilot.state.hold.plan.is_common for pilot in team.pilots)
