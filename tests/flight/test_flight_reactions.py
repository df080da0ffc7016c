"""What a flight does about a failsafe, in each of its phases: the phase that follows, what vehicles are told."""

import math
from itertools import combinations
from types import SimpleNamespace

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from flights import MISSIONS

from gcs.flight import stack
from gcs.flight.alarms import AlarmLog
from gcs.flight.condition import Trigger
from gcs.flight.failsafe import Failsafe
from gcs.flight.flight import Flight
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.flight.phase import CONTROLLED, Phase
from gcs.mavlink import px4
from gcs.mission.read import read_mission
from idc_controller.guidance.progress import Guidance

MISSION = read_mission(MISSIONS / "short_leg.toml")
PARAMETERS = MISSION.system.parameters()
ARM, MODE = mavlink.MAV_CMD_COMPONENT_ARM_DISARM, mavlink.MAV_CMD_DO_SET_MODE


class Watched(Flight):
    """A flight that keeps the commands to the team."""

    def __init__(self, phase):
        self.commands = []
        team = SimpleNamespace(links=(), command_all=lambda *command: self.commands.append(command))
        control = SimpleNamespace(
            estimator=None,
            links=None,
            resting_place=None,
            controller=SimpleNamespace(parameters=PARAMETERS, guidance=Guidance(), load=None),
        )
        super().__init__(MISSION, team, control, AlarmLog(), stack.obstacle_map(MISSION))
        self.phase = phase
        if phase in (Phase.CLIMB, Phase.FLY, Phase.LAND):
            self.flown.trajectory = MissionTrajectory(MISSION, np.zeros(3), 0.0)

    def fails(self, failsafe, time=5.0, **trigger):
        self.raise_failsafe(time, failsafe, Trigger("a reason", **trigger))


@pytest.mark.parametrize("phase", [Phase.CONNECT, Phase.CHECK])
def test_flight_that_has_not_begun_is_refused(phase):
    flight = Watched(phase)
    flight.fails(Failsafe.PREARM_CHECK_FAILED)
    assert (flight.phase, flight.commands, flight.reason) == (Phase.ENDED, [], "a reason")
    assert flight.ended and not flight.landed


def test_interrupt_between_two_flights_ends_the_mission_where_it_stands():
    flight = Watched(Phase.ON_GROUND)
    flight._ending = SimpleNamespace(done=True)  # the vehicles have disarmed
    flight.fails(Failsafe.INTERRUPTED)
    assert (flight.phase, flight.commands, flight.reason) == (Phase.ENDED, [], "a reason")
    assert flight.landed and not flight.completed and flight.failsafes.interrupted


@pytest.mark.parametrize("phase", [Phase.ARM, Phase.SPOOL_UP])
def test_vehicles_still_on_the_ground_are_disarmed(phase):
    flight = Watched(phase)
    flight.payload_control.in_cradles = lambda time: True
    flight.fails(Failsafe.OFFBOARD_LEFT)
    assert flight.phase is Phase.DISARM
    assert [command[:2] for command in flight.commands] == [(ARM, 0.0)]


def test_vehicles_above_their_cradles_hold_with_one_that_is_lost_and_spool_down_for_less():
    flight = Watched(Phase.SPOOL_UP)
    stood = []
    flight.payload_control.stand = lambda time, estimate: stood.append(time)
    flight.fails(Failsafe.ATTITUDE_MISALIGNED)
    assert (flight.phase, flight.commands) == (Phase.SPOOL_UP, [])
    flight._advance(5.0, None, np.ones(4))
    assert (flight.phase, stood) == (Phase.SPOOL_DOWN, [5.0])
    flight.fails(Failsafe.OFFBOARD_LEFT)
    assert flight.phase is Phase.AUTONOMOUS_LANDING


@pytest.mark.parametrize("phase", [Phase.CLIMB, Phase.FLY])
def test_interrupted_flight_brakes_and_lands_under_control(phase):
    undisturbed, flight = Watched(phase), Watched(phase)
    flight.fails(Failsafe.INTERRUPTED)
    assert (flight.phase, flight.commands) == (phase, [])
    assert flight.flown.expected_end < undisturbed.flown.expected_end or math.isinf(undisturbed.flown.expected_end)
    path = flight.flown.trajectory.trajectory.derivatives(np.linspace(5.0, 60.0, 200), 0)[0]
    assert np.ptp(path[:, :2], axis=0).max() < 2.0


@pytest.mark.parametrize("phase", [Phase.FLY, Phase.SPOOL_DOWN])
def test_lost_vehicle_lands_all(phase):
    flight = Watched(phase)
    flight.fails(Failsafe.TELEMETRY_LOST, vehicles=())
    assert flight.phase is Phase.AUTONOMOUS_LANDING
    assert flight.commands == [
        (MODE, mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED, px4.MainMode.AUTO, px4.AutoMode.LOITER)
    ]


def test_ground_that_has_lost_all_sends_nothing_more():
    flight = Watched(Phase.FLY)
    flight.fails(Failsafe.INTERRUPTED_TWICE)
    assert (flight.phase, flight.commands) == (Phase.ENDED, [])


def test_more_severe_reaction_takes_over_and_is_not_taken_back():
    flight = Watched(Phase.FLY)
    flight.fails(Failsafe.INTERRUPTED)
    flight.fails(Failsafe.TELEMETRY_LOST)
    assert flight.phase is Phase.AUTONOMOUS_LANDING
    told = list(flight.commands)
    flight.fails(Failsafe.NO_PATH)
    assert (flight.phase, flight.commands) == (Phase.AUTONOMOUS_LANDING, told)
    assert flight.failsafes.raised == {Failsafe.INTERRUPTED, Failsafe.TELEMETRY_LOST, Failsafe.NO_PATH}


@pytest.mark.parametrize("phase", [phase for phase in Phase if phase not in (Phase.AUTONOMOUS_LANDING, Phase.ENDED)])
def test_two_failsafes_at_one_step_lead_to_the_same_reaction_and_state_in_either_order(phase):
    for pair in combinations((Failsafe.LANDING_ABORTED, Failsafe.INTERRUPTED, Failsafe.TELEMETRY_LOST), 2):
        outcomes = []
        for failsafes in (pair, pair[::-1]):
            flight = Watched(phase)
            for failsafe in failsafes:
                flight.fails(failsafe)
            outcomes.append((flight.failsafes.reaction, flight.phase, flight.commands))
        assert outcomes[0] == outcomes[1], pair
        reacting = Watched(phase)._team_state
        assert outcomes[0][0] is reacting.reaction(max(failsafe.reaction for failsafe in pair))


def test_failsafe_after_the_end_is_left_alone():
    flight = Watched(Phase.ENDED)
    flight.fails(Failsafe.TELEMETRY_LOST)
    assert (flight.phase, flight.commands, flight.reason) == (Phase.ENDED, [], "")


def test_links_are_checked_while_the_rotors_carry_anything():
    for phase in Phase:
        flight, asked = Watched(phase), []
        flight.failsafes.evaluate = lambda check, moment, state, asked=asked: asked.append(moment)
        assert not flight.check_links(1.0, 2.0)
        assert bool(asked) == (phase in CONTROLLED)
