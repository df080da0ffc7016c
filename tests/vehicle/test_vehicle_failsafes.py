"""A vehicle that receives nothing goes through the states of the team, as the table has them."""

import math

import pytest
from flying import AIRFRAME
from onboard import step_alone

from gcs.config.vehicle_settings import AutopilotSettings
from gcs.mavlink import px4
from gcs.mavlink.team_failsafe import TeamState
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.failsafe import FAILSAFES
from vehicle_sim.autopilot.free import failsafe as free
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters
from vehicle_sim.world.sensors import Measurement

STEP = 0.02
GROUND = -3.0
"""Where it stands after a descent from -5 (m, down)."""


class Silent:
    """A vehicle that is where it plans to be, above the ground, and receives nothing once it has come to ``state``."""

    def __init__(self, state):
        self.aside = 0.0  # m/s; of a vehicle that stands
        self.now, self.parameters = 0.0, vehicle_parameters(AIRFRAME, 1, 250, AutopilotSettings())
        self.pilot = Autopilot(AIRFRAME, self.parameters)
        self.step()
        self.pilot.ground_heard(0.0)
        self.pilot.enter_offboard(AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0, 0), 0.0, 0.0)
        if state is not TeamState.DISARMED:
            assert self.pilot.arm(0.0, force=True).text == ""
        if state not in (TeamState.DISARMED, TeamState.ARMED):
            self.pilot.state.land.lift(1.5 * AIRFRAME.mass * AIRFRAME.g)
        if state in (TeamState.HOLD, TeamState.LAND):
            self.pilot.enter_mode(state.mode, 0.0)
            self.step()

    @property
    def state(self):
        return self.pilot.state.team_state

    def step(self):
        self.now += STEP
        hold = self.pilot.state.hold
        down, sinking = (-5.0, 0.0) if hold is None else (each[2] for each in hold.plan.at(self.now)[:2])
        velocity = (0.0, 0.0, sinking) if down < GROUND else (self.aside, 0.0, 0.0)
        sample = Measurement(self.now, (1, 0, 0, 0), (0, 0, 0), (0.0, 0.0, min(down, GROUND)), velocity)
        step_alone(self.pilot, sample, self.now)

    def states(self):
        """Return the states that follow, each with the time (s) since the one before."""
        passed, since, state = [], self.now, self.state
        while state is not TeamState.DISARMED:
            assert self.now < 60.0, state
            self.step()
            if self.state is not state:
                passed.append((self.state, self.now - since))
                state, since = self.state, self.now
        return passed


@pytest.mark.parametrize("state", TeamState)
def test_vehicle_that_receives_nothing_enters_each_next_state_by_its_timer_until_it_is_disarmed(state):
    vehicle = Silent(state)
    assert vehicle.state is state
    commanded = state
    for following, lasted in vehicle.states():
        assert following is state.next
        if timer := px4.PARAM_LINK_LOSS if commanded is state is TeamState.HOLD else state.timer:
            assert lasted == pytest.approx(vehicle.parameters[timer], abs=2.5 * STEP), state
        state = following
    assert state is TeamState.DISARMED
    for _ in range(math.ceil(vehicle.parameters[TeamState.ARMED.timer] / STEP)):
        vehicle.step()
    assert vehicle.state is TeamState.DISARMED and vehicle.pilot.mode == TeamState.DISARMED.mode


def test_vehicle_that_is_armed_on_the_ground_in_hold_is_disarmed_without_a_ground():
    vehicle = Silent(TeamState.ARMED)
    vehicle.pilot.enter_mode(px4.MODE_HOLD, vehicle.now)
    assert vehicle.state is TeamState.ARMED
    ((state, after),) = vehicle.states()
    assert state is TeamState.DISARMED
    assert after == pytest.approx(vehicle.parameters[px4.PARAM_LINK_LOSS], abs=2.5 * STEP)


@pytest.mark.parametrize(("slows_after", "waits"), [(0.0, 0.0), (2.0, 2.0), (60.0, 5.0)])
def test_rotors_stop_once_a_vehicle_that_stands_is_at_rest_or_after_a_timeout(slows_after, waits):
    at_rest, moving = Silent(TeamState.LAND), Silent(TeamState.LAND)
    at_rest.states()
    moving.aside = 0.4
    while moving.state is not TeamState.DISARMED:
        if moving.now > at_rest.now + slows_after - 1.5 * STEP:
            moving.aside = 0.0
        moving.step()
    assert moving.now - at_rest.now == pytest.approx(waits, abs=3.5 * STEP)


def test_each_failsafe_of_a_vehicle_with_a_team_ends_a_state_of_the_table():
    assert {failsafe.state for failsafe in FAILSAFES} == {*TeamState} - {TeamState.LAND}
    assert all(failsafe.parameter == failsafe.state.timer for failsafe in FAILSAFES if failsafe.name == "offboard_loss")


def test_notices_of_failsafes_fit_one_statustext():
    assert all(len(failsafe.notice) <= 50 for failsafe in (*FAILSAFES, *free.FAILSAFES))
