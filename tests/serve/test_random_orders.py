"""Random orders in flight and on the ground: nothing ends the program, the payload stays level and touches nothing."""

from __future__ import annotations

import math
import random
from pathlib import Path
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
import pytest
from team_bench import TeamBench, Truth, reposition, set_mode, team_command
from team_session import ARM, DISARM, LAND, MISSION, RETURN, START, at, change_speed, take_off

from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import PlanType
from gcs.mission.read import read_mission

pytestmark = pytest.mark.long
SECONDS, INTERVAL = 120.0, 0.5
TILT = 15.0
"""deg; beyond which no order tilts the payload."""
HOSTILE = (math.nan, math.inf, -math.inf, -1.0, 0.0, 1e-9, 1e9)
PLAN = [MISSION[0]._replace(z=2.0), at(3.0, 0.0, 2.0), at(3.0, 2.0, 2.5), at(0.0, 2.0, 2.0)]
NUMBERS = (
    m.MAV_CMD_NAV_TAKEOFF, m.MAV_CMD_DO_REPOSITION, m.MAV_CMD_DO_CHANGE_SPEED, m.MAV_CMD_MISSION_START,
    m.MAV_CMD_DO_SET_MISSION_CURRENT, m.MAV_CMD_DO_PAUSE_CONTINUE, m.MAV_CMD_DO_SET_MODE, m.MAV_CMD_DO_ORBIT,
    m.MAV_CMD_COMPONENT_ARM_DISARM, m.MAV_CMD_CONDITION_YAW, m.MAV_CMD_DO_SET_HOME,
)  # fmt: skip


def order(rng: random.Random) -> Any:
    """Return an order; one in five has parameters that mean nothing."""
    if rng.random() < 0.2:
        return team_command(rng.choice(NUMBERS), *(rng.choice(HOSTILE) for _ in range(7)))
    place = rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0), rng.uniform(0.0, 4.0)
    return rng.choice(
        [
            ARM, ARM, START, START, take_off(rng.uniform(0.5, 3.0)), take_off(2.0), RETURN, LAND, DISARM,
            *(set_mode(mode) for mode in (px4.MODE_HOLD, px4.MODE_HOLD, px4.MODE_MISSION, px4.MODE_RETURN)),
            *[reposition(*place, rng.uniform(0.0, 3.5))] * 4, change_speed(rng.uniform(0.0, 3.5)),
            team_command(m.MAV_CMD_DO_SET_MISSION_CURRENT, rng.randrange(5)),
        ]
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(1, 9))
def test_random_orders_leave_the_payload_level_and_end_disarmed(tmp_path: Path, seed: int) -> None:
    rng, phases = random.Random(seed), set()
    with TeamBench(read_mission("hover", None, {"team.vehicles": 3}), tmp_path) as team:
        team.ready()
        assert team.upload(PLAN, PlanType.MISSION)[0] == m.MAV_MISSION_ACCEPTED
        while team.now < SECONDS:
            team.send(order(rng))
            team.run(INTERVAL)
            phases.add(team.server.session.flight.phase.value)
        team.land_and_close()
        assert not team.server.report.armed
    truth = Truth(tmp_path)
    assert truth.contacts.max() == 0
    assert truth.tilt.max() < TILT
    assert -truth.position[-1, 2] < 0.35, "it stands on the ground"
    assert {"climb", "fly"} <= phases
