"""Four vehicles without a payload at the same time, each through a mission of its own that MAVSDK has uploaded."""

import numpy as np
import pytest
from client_swarm import FRAME, client_swarm
from mavsdk.plugins.mission_raw import MissionItem
from mavsdk_client import Steps, first, together

pytestmark = pytest.mark.slow

TAKEOFF, WAYPOINT, RETURN = 22, 16, 20
RELATIVE, MISSION = 6, 2
ACCEPTANCE = 0.3  # m
POINTS = {i: (3.0 + 0.5 * i, 2.0 * (i - 1), 2.0 + 0.5 * i) for i in (1, 2, 3, 4)}
"""Waypoint by vehicle: north of its place, east, up (m)."""


def items_of(vehicle):
    north, east, up = POINTS[vehicle]
    rows = [(TAKEOFF, RELATIVE, 0.0, east, up), (WAYPOINT, RELATIVE, north, east, up), (RETURN, MISSION, 0.0, 0.0, 0.0)]
    items = []
    for number, (command, frame, x, y, z) in enumerate(rows):
        place = (0, 0) if command == RETURN else tuple(round(1e7 * a) for a in FRAME.geodetic(x, y, 0.0)[:2])
        items.append(MissionItem(number, frame, command, int(number == 0), 1, 0.0, ACCEPTANCE, 0.0, 0.0, *place, z, 0))
    return items


def test_four_vehicles_fly_four_missions_at_the_same_time(tmp_path):
    with client_swarm(tmp_path / "run", "--free", "--vehicles", "4") as swarm:
        steps = {i: Steps(swarm) for i in POINTS}

        def program(vehicle):
            async def fly(client):
                await client.mission_raw.upload_mission(items_of(vehicle))
                downloaded = await client.mission_raw.download_mission()
                assert [item.command for item in downloaded] == [TAKEOFF, WAYPOINT, RETURN]
                await client.action.arm()
                flies = first(client.telemetry.subscribe_in_air(), lambda flies: flies)
                await steps[vehicle]("fly", client.mission_raw.start_mission(), flies, client.disarmed())

            return fly

        together({swarm.sdk_port(i): program(i) for i in POINTS})
        for i, point in POINTS.items():
            track = steps[i].track("fly", i)
            assert track.nearest(*point) < 0.6
            assert np.linalg.norm(track.position[-1, :2] - (0.0, point[1])) < 0.3
            assert track.height[-1] < 0.05 and track.thrust[-1] < 1e-6
