"""MAVSDK 4 uploads missions to vehicles without a payload, and both fly theirs at the same time."""

import asyncio
import math

import numpy as np
import pytest
from client_swarm import FRAME
from mavsdk.plugins.mission import MissionItem, MissionPlan
from mavsdk.plugins.mission_raw import MissionItem as RawItem
from mavsdk.plugins.mission_raw import MissionRawError, MissionRawResult
from mavsdk_client import Steps, first, fly, second, together

pytestmark = pytest.mark.slow

TAKEOFF, WAYPOINT, RETURN, DELAY, SERVO = 22, 16, 20, 93, 183
FENCE_CIRCLE, RALLY_POINT = 5003, 5100
LOCAL_ORIGIN, RELATIVE, MISSION = 1, 6, 2
HOMES = {1: 0.0, 2: 2.0}  # m, east
POINTS = {1: [(3.0, 0.0, 2.0), (3.0, -2.0, 2.5), (0.0, -2.0, 2.5)], 2: [(-3.0, 2.0, 3.0), (-3.0, 4.0, 2.0)]}
"""Waypoints by vehicle: north, east, up (m)."""


def plan(points):
    """Waypoints of MAVSDK's own kind."""
    places = [FRAME.geodetic(north, east, 0.0)[:2] for north, east, _ in points]
    return MissionPlan([
        MissionItem(*place, up, 3.0, True, acceptance_radius_m=0.3)
        for place, (_, _, up) in zip(places, points, strict=True)
    ])  # fmt: skip


def raw(*items, kind=0):
    """Items as of MISSION_ITEM_INT, of (command, frame, place, first parameter)."""
    found = []
    for sequence, (command, frame, (north, east, up), parameter) in enumerate(items):
        latitude, longitude, _ = FRAME.geodetic(north, east, 0.0)
        x, y = (round(latitude * 1e7), round(longitude * 1e7)) if frame != MISSION else (0, 0)
        rest = (0.3, 0.0, math.nan) if command == WAYPOINT else (0.0, 0.0, 0.0)  # acceptance radius (m), yaw
        found.append(RawItem(sequence, frame, command, int(sequence == 0 == kind), 1, parameter, *rest, x, y, up, kind))
    return found


def fields(items):
    """The fields of raw items, rounded as the wire does; NaN is None."""
    return [
        {
            name: None if value != value else np.float32(value) if isinstance(value, float) else value
            for name, value in vars(item).items()
        }
        for item in items
    ]


MISSION_2 = raw(
    (TAKEOFF, RELATIVE, (0.0, 2.0, 2.0), 0.0),
    *((WAYPOINT, RELATIVE, point, 0.0) for point in POINTS[2]),
    (RETURN, MISSION, (0.0, 0.0, 0.0), 0.0),
)


@pytest.fixture(scope="module")
def flown(free_swarm):
    """One flies a mission of the plugin Mission, is paused and goes on; the other one of MissionRaw, and lands."""
    steps = {vehicle: Steps(free_swarm) for vehicle in HOMES}

    async def first_vehicle(client):
        mission, step = client.mission, steps[1]
        await mission.upload_mission(plan(POINTS[1]))
        step.results["downloaded"] = (await mission.download_mission()).mission_items
        await client.action.arm()
        progress = []
        watching = asyncio.create_task(watch(mission.subscribe_mission_progress(), progress))
        await step(
            "begin", mission.start_mission(),
            first(client.telemetry.subscribe_position_velocity_ned(), lambda m: m.position.north_m > 1.0),
        )  # fmt: skip
        still = first(client.telemetry.subscribe_velocity_ned(), lambda v: math.hypot(v.north_m_s, v.east_m_s) < 0.1)
        await step("pause", mission.pause_mission(), still, second(client.telemetry.subscribe_home()))
        await step(
            "go on", mission.start_mission(),
            first(mission.subscribe_mission_progress(), lambda p: p.current == p.total),
        )  # fmt: skip
        watching.cancel()
        step.results["finished"] = await mission.is_mission_finished()
        step.results["progress"] = progress
        await mission.set_current_mission_item(1)
        await step("again", mission.start_mission(), client.is_at(3.0, -2.0, -2.5, 0.5))
        await step("land", client.land())

    async def second_vehicle(client):
        mission, step = client.mission_raw, steps[2]
        await client.param.set_param_float("RTL_RETURN_ALT", 2.0)
        await client.param.set_param_float("RTL_DESCEND_ALT", 2.0)
        await mission.upload_mission(MISSION_2)
        step.results["downloaded"] = await mission.download_mission()
        await client.action.arm()
        progress = []
        watching = asyncio.create_task(watch(mission.subscribe_mission_progress(), progress))
        await step(
            "fly", mission.start_mission(), first(client.telemetry.subscribe_in_air(), lambda flies: flies),
            client.disarmed(),
        )  # fmt: skip
        watching.cancel()
        step.results["progress"] = progress

    together({free_swarm.sdk_port(1): first_vehicle, free_swarm.sdk_port(2): second_vehicle})
    return steps


async def watch(progress, seen):
    async for message in progress:
        if not seen or message.current != seen[-1]:
            seen.append(message.current)


def test_mission_is_flown_through_all_its_waypoints(flown):
    step = flown[1]
    tracks = [step.track(name) for name in ("begin", "pause", "go on")]
    for point in POINTS[1]:
        assert min(track.nearest(*point) for track in tracks) < 0.5
    assert step.results["finished"]
    progress = step.results["progress"]
    assert progress == sorted(progress) and progress[-1] == len(POINTS[1])


def test_mission_is_downloaded_as_it_was_uploaded(flown):
    for item, point in zip(flown[1].results["downloaded"], POINTS[1], strict=True):
        latitude, longitude, _ = FRAME.geodetic(*point[:2], 0.0)
        assert (item.latitude_deg, item.longitude_deg) == pytest.approx((latitude, longitude), abs=1e-7)
        assert (item.relative_altitude_m, item.speed_m_s) == pytest.approx((point[2], 3.0))
        assert item.acceptance_radius_m == pytest.approx(0.3)
    assert fields(flown[2].results["downloaded"]) == fields(MISSION_2)


def test_mission_is_paused_and_goes_on(flown):
    paused = flown[1].track("pause")
    assert np.linalg.norm(paused.velocity[-1]) < 0.2 and paused.position[-1, 0] < 3.5
    assert flown[1].modes("pause") == ["AUTO.LOITER"]
    assert flown[1].modes("go on")[0] == "AUTO.MISSION"


def test_mission_is_flown_from_the_item_that_was_set(flown):
    track = flown[1].track("again")
    assert track.nearest(*POINTS[1][1]) < 0.6
    assert track.nearest(*POINTS[1][0]) > 1.0


def test_two_vehicles_fly_their_own_missions_at_the_same_time(flown):
    track = flown[2].track("fly", vehicle=2)
    for point in POINTS[2]:
        assert track.nearest(*point) < 0.6
    assert np.linalg.norm(track.position[-1, :2] - (0.0, HOMES[2])) < 0.3
    assert track.height[-1] < 0.05 and track.thrust[-1] < 1e-6
    assert flown[2].modes("fly", vehicle=2)[-3:] == ["AUTO.MISSION", "AUTO.RTL", "AUTO.LOITER"]
    both = flown[1].track("go on").time
    assert track.time[0] < both[0] < track.time[-1]


def test_fence_and_rally_points_come_back_as_they_were(free_swarm):
    fence = raw((FENCE_CIRCLE, 3, (1.0, 2.0, 0.0), 50.0), kind=1)
    rally = raw((RALLY_POINT, 3, (2.0, 2.0, 10.0), 0.0), kind=2)

    async def program(client):
        mission = client.mission_raw
        await mission.upload_geofence(fence)
        await mission.upload_rally_points(rally)
        await mission.clear_mission()
        return [fields(await read()) for read in (mission.download_geofence, mission.download_rallypoints)]

    assert fly(free_swarm.sdk_port(2), program) == [fields(fence), fields(rally)]


def test_mission_that_cannot_be_flown_is_refused_and_the_old_one_kept(free_swarm):
    wrong = raw((WAYPOINT, LOCAL_ORIGIN, (0.0, 0.0, 2.0), 0.0))

    async def program(client):
        mission = client.mission_raw
        await mission.upload_mission(MISSION_2)
        with pytest.raises(MissionRawError) as refused:
            await mission.upload_mission(wrong)
        return refused.value.result, fields(await mission.download_mission())

    assert fly(free_swarm.sdk_port(2), program) == (MissionRawResult.UNSUPPORTED, fields(MISSION_2))
