"""Sequences of commands: arm, disarm, land autonomously; in which order, when, done or failed."""

import pymavlink.dialects.v20.common as mavlink
import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.command_sequences import Arming, AutonomousLanding, Disarming
from gcs.mavlink import px4

TIMEOUT = DEFAULTS.failsafe.landing_timeout
LOITER, LAND = ((1.0, px4.MainMode.AUTO, mode) for mode in (px4.AutoMode.LOITER, px4.AutoMode.LAND))


class Team:
    """A team that keeps its commands; its vehicles that are reached are disarmed once it is ``landed``."""

    land_delay, landed, waits, unanswered = 15.0, False, False, False

    def __init__(self):
        self.commands, self.asked = [], []

    def command_all(self, number, *parameters):
        assert number == mavlink.MAV_CMD_DO_SET_MODE
        self.commands.append(parameters)

    def reachable_are_disarmed(self, now, timeout):
        self.asked.append((now, timeout))
        return self.landed


@pytest.fixture
def team():
    return Team()


def test_team_holds_then_descends_once_after_the_delay(team):
    landing = AutonomousLanding(team, 100.0)
    assert team.commands == [LOITER] and landing.descent_pending
    for time, commands in ((100.1, 1), (114.9, 1), (115.0, 2), (115.1, 2), (130.0, 2)):
        landing.step(time, time - 3.0)
        assert (len(team.commands), landing.descent_pending) == (commands, commands == 1)
    assert team.commands == [LOITER, LAND]
    assert not landing.done and landing.problem == ""
    # One that is silent in a burst of losses alone has not gone.
    assert team.asked[-1] == (127.0, DEFAULTS.failsafe.data_link_timeout)


def test_landing_is_done_when_the_reachable_vehicles_are_disarmed(team):
    landing = AutonomousLanding(team, 100.0)
    landing.step(115.0, 0.0)
    team.landed = True
    landing.step(100.0 + TIMEOUT + 1.0, 0.0)
    assert landing.done and landing.problem == ""


def test_landing_commands_the_descent_before_it_is_done(team):
    """A vehicle without telemetry may hold still when those that are heard are down."""
    landing = AutonomousLanding(team, 100.0)
    team.landed = True
    landing.step(102.0, 0.0)
    assert team.commands == [LOITER, LAND] and not landing.done
    team.waits = True
    landing.step(102.1, 0.0)
    assert not landing.done
    team.waits = False
    landing.step(103.0, 0.0)
    assert landing.done and len(team.commands) == 2


def test_descent_is_commanded_again_where_a_vehicle_has_not_answered(team):
    landing = AutonomousLanding(team, 100.0)
    for time, waits, unanswered, commands in (
        (115.0, False, False, 2), (115.1, True, False, 2), (120.0, False, True, 3), (120.1, True, False, 3),
        (121.0, False, False, 3),
    ):  # fmt: skip
        team.waits, team.unanswered = waits, unanswered
        landing.step(time, 0.0)
        assert len(team.commands) == commands
    team.landed, team.waits = True, True
    landing.step(130.0, 0.0)
    assert landing.done


@pytest.mark.parametrize(("late", "failed"), [(-0.1, False), (0.1, True)])
def test_landing_fails_after_its_timeout(team, late, failed):
    landing = AutonomousLanding(team, 100.0)
    landing.step(100.0 + TIMEOUT + late, 0.0)
    assert not landing.done
    assert landing.problem == (f"not every vehicle has landed after {TIMEOUT:g} s" if failed else "")


class Answering:
    """A team that keeps its commands and answers them when it is told to."""

    def __init__(self):
        self.commands = []
        self.answered, self.refusal, self.armed, self.disarmed = False, None, False, False

    def command_all(self, number, *parameters):
        self.commands.append((number, *parameters))
        self.answered, self.refusal = False, None


OFFBOARD = (mavlink.MAV_CMD_DO_SET_MODE, 1.0, px4.MainMode.OFFBOARD, 0)
ARM, DISARM = ((mavlink.MAV_CMD_COMPONENT_ARM_DISARM, value) for value in (1.0, 0.0))
DELAY = DEFAULTS.takeoff_landing.offboard_delay
ARM_TIMEOUT, DISARM_TIMEOUT = DEFAULTS.failsafe.arm_timeout, DEFAULTS.failsafe.disarm_timeout


def test_team_enters_offboard_after_the_delay_arms_when_that_is_answered_and_is_done_when_armed():
    team = Answering()
    arming = Arming(team, 100.0)
    for elapsed, commands in ((0.0, []), (0.99 * DELAY, []), (1.01 * DELAY, [OFFBOARD]), (1.2 * DELAY, [OFFBOARD])):
        arming.step(100.0 + elapsed, 0.0)
        assert team.commands == commands
    team.answered = True
    for _ in range(3):
        arming.step(100.0 + 1.3 * DELAY, 0.0)
        assert team.commands == [OFFBOARD, ARM] and not arming.done
    for team.answered, team.armed in ((True, False), (False, True)):
        arming.step(100.0 + 1.4 * DELAY, 0.0)
        assert not arming.done
    team.answered = True
    arming.step(100.0 + 1.5 * DELAY, 0.0)
    assert arming.done and arming.problem == "" and team.commands == [OFFBOARD, ARM]


@pytest.mark.parametrize(("late", "failed"), [(-0.1, False), (0.1, True)])
def test_arming_fails_after_its_timeout(late, failed):
    arming = Arming(Answering(), 100.0)
    arming.step(100.0 + ARM_TIMEOUT + late, 0.0)
    assert arming.problem == (f"not every vehicle is armed after {ARM_TIMEOUT:g} s" if failed else "")
    assert not arming.done


def test_refusal_ends_arming_with_its_reason():
    team = Answering()
    arming = Arming(team, 100.0)
    team.refusal = "vehicle 2 refused to arm"
    arming.step(100.0, 0.0)
    assert arming.problem == "vehicle 2 refused to arm" and not arming.done and team.commands == []


def test_team_is_disarmed_by_force_once_where_a_vehicle_refuses():
    team = Answering()
    disarming = Disarming(team, 100.0)
    disarming.step(100.1, 0.0)
    assert team.commands == [DISARM] and not disarming.done
    team.refusal = "in the air"
    disarming.step(100.2, 0.0)
    disarming.step(100.3, 0.0)
    assert team.commands == [DISARM, (*DISARM, px4.FORCE_ARM_DISARM)] and disarming.problem == ""
    for team.answered, team.disarmed in ((True, False), (False, True)):
        disarming.step(100.4, 0.0)
        assert not disarming.done
    team.answered = True
    disarming.step(100.5, 0.0)
    assert disarming.done and disarming.problem == "" and len(team.commands) == 2


def test_disarming_fails_where_force_is_refused_or_after_its_timeout():
    team = Answering()
    disarming = Disarming(team, 100.0)
    for _ in range(2):
        team.refusal = "no"
        disarming.step(100.1, 0.0)
    assert disarming.problem == "no" and not disarming.done
    for late, failed in ((-0.1, False), (0.1, True)):
        disarming = Disarming(Answering(), 100.0)
        disarming.step(100.0 + DISARM_TIMEOUT + late, 0.0)
        assert disarming.problem == (f"not every vehicle is disarmed after {DISARM_TIMEOUT:g} s" if failed else "")
        assert not disarming.done
