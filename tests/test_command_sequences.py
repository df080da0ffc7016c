"""Autonomous landing: hold, descend when a vehicle would that receives nothing, done or failed."""

import pymavlink.dialects.v20.common as mavlink
import pytest

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.command_sequences import AutonomousLanding
from gcs.mavlink import px4

TIMEOUT = DEFAULTS.failsafe.landing_timeout
LOITER, LAND = ((1.0, px4.MainMode.AUTO, mode) for mode in (px4.AutoMode.LOITER, px4.AutoMode.LAND))


class Team:
    """A team that keeps its commands; its vehicles that are reached are disarmed once it is ``landed``."""

    land_delay, landed = 15.0, False

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
    assert team.asked[-1] == (127.0, DEFAULTS.failsafe.telemetry_timeout)


def test_landing_is_done_when_the_reachable_vehicles_are_disarmed(team):
    landing = AutonomousLanding(team, 100.0)
    team.landed = True
    landing.step(100.0 + TIMEOUT + 1.0, 0.0)
    assert landing.done and landing.problem == ""


@pytest.mark.parametrize(("late", "failed"), [(-0.1, False), (0.1, True)])
def test_landing_fails_after_its_timeout(team, late, failed):
    landing = AutonomousLanding(team, 100.0)
    landing.step(100.0 + TIMEOUT + late, 0.0)
    assert not landing.done
    assert landing.problem == (f"not every vehicle has landed after {TIMEOUT:g} s" if failed else "")
