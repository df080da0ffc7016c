"""Fence and rally points of a free vehicle: uploaded, and what it does at a breach."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, OFFBOARD, FreeBench, item, mode

from gcs.mavlink import px4
from gcs.mavlink.services.mission_item import PlanType
from vehicle_sim.autopilot.free.fence import Circle, Fence, Polygon

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
IN_POLYGON, OUT_OF_POLYGON = 5001, 5002
IN_CIRCLE, OUT_OF_CIRCLE = 5003, 5004
SQUARE = ((-12.0, -12.0), (-12.0, 12.0), (12.0, 12.0), (12.0, -12.0))


def polygon(command, corners=SQUARE):
    return [item(command, north, east, 0.0, float(len(corners))) for north, east in corners]


def circle(command, north, east, radius):
    return [item(command, north, east, 0.0, radius)]


def upload(bench, plan_type, items):
    """Upload a plan over the wire, and return the MAV_MISSION_RESULT."""
    bench.messages.clear()
    bench.send(mavlink.MAVLink_mission_count_message(1, 1, len(items), plan_type))
    for number, part in enumerate(items):
        frame, command, autocontinue, *values, x, y, z = part
        bench.send(
            mavlink.MAVLink_mission_item_int_message(
                1, 1, number, frame, command, 0, autocontinue, *values, x, y, z, plan_type
            )
        )
    [*_, ack] = [m for _, _, m in bench.messages if m.get_type() == "MISSION_ACK"]
    return ack.type


def fly_north(bench, distance=40.0):
    """Fly north, though the fence would refuse it as a go-to, by velocity set-points."""
    bench.streaming[1] = mavlink.MAVLink_set_position_target_local_ned_message(
        0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, 0b1101_1100_0111, 0, 0, 0, 4.0, 0, 0, *[0.0] * 5
    )
    bench.run(0.3)
    assert bench.command(*OFFBOARD) == ACCEPTED


@pytest.mark.parametrize("items", [polygon(IN_POLYGON), circle(IN_CIRCLE, 0.0, 0.0, 12.0)])
@pytest.mark.parametrize(
    ("action", "flown"), [(1, "OFFBOARD"), (2, "AUTO.LOITER"), (3, "AUTO.RTL"), (5, "AUTO.LAND"), (0, "OFFBOARD")]
)
def test_action_at_the_boundary(items, action, flown):
    with FreeBench() as bench:
        bench.set_parameter("GF_ACTION", action)
        assert upload(bench, PlanType.FENCE, items) == mavlink.MAV_MISSION_ACCEPTED
        bench.take_off()
        fly_north(bench)
        bench.messages.clear()
        assert bench.run(10.0, lambda: bench.position()[0] > 11.5)
        assert bench.mode_of() == "OFFBOARD" and "Fence" not in bench.texts()
        bench.run(0.4)
        assert bench.mode_of() == flown
        assert bench.vehicles[0].autopilot.failsafe == (action > 1)
        assert bench.texts().count("Fence breach: outside the inclusion areas") == (action > 0)
        if action > 1:
            bench.run(4.0)  # the set-points that still come do not end it
            assert bench.mode_of() == flown and bench.path()[:, 0].max() < 18.0


def test_vehicle_that_held_outside_may_be_commanded_and_breaches_again():
    with FreeBench() as bench:
        assert upload(bench, PlanType.FENCE, polygon(IN_POLYGON)) == mavlink.MAV_MISSION_ACCEPTED
        bench.set_parameter("RTL_RETURN_ALT", 6.0)
        bench.take_off()
        fly_north(bench)
        assert bench.run(10.0, lambda: bench.mode_of() == "AUTO.LOITER")
        bench.streaming.clear()
        bench.run(3.0)
        assert bench.position()[0] > 12.0
        assert bench.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == ACCEPTED
        assert bench.run(10.0, lambda: bench.position()[0] < 8.0)
        assert bench.mode_of() == "AUTO.RTL"
        fly_north(bench)
        assert bench.run(10.0, lambda: bench.mode_of() == "AUTO.LOITER")
        assert bench.position()[0] > 11.5


@pytest.mark.parametrize(
    "items", [circle(OUT_OF_CIRCLE, 20.0, 0.0, 6.0), polygon(OUT_OF_POLYGON, [(14, -5), (14, 5), (26, 5), (26, -5)])]
)
def test_exclusion_areas_are_not_entered(items):
    with FreeBench() as bench:
        assert upload(bench, PlanType.FENCE, items) == mavlink.MAV_MISSION_ACCEPTED
        bench.take_off()
        answer = bench.vehicles[0].autopilot.go_to((20.0, 0.0, -5.0), NAN, NAN, bench.now)
        assert answer.result == DENIED and "in an exclusion area" in answer.text
        fly_north(bench)
        assert bench.run(10.0, lambda: bench.mode_of() == "AUTO.LOITER")
        assert bench.position()[0] == pytest.approx(14.0, abs=0.5)
        assert upload(bench, PlanType.FENCE, []) == mavlink.MAV_MISSION_ACCEPTED
        assert bench.vehicles[0].autopilot.go_to((20.0, 0.0, -5.0), NAN, NAN, bench.now).result == ACCEPTED


@pytest.mark.parametrize(
    ("name", "limit", "velocity", "axis"),
    [("GF_MAX_HOR_DIST", 9.0, (3.0, 0.0, 0.0), 0), ("GF_MAX_VER_DIST", 8.0, (0.0, 0.0, -2.0), 2)],
)
def test_limits_about_home(name, limit, velocity, axis):
    with FreeBench() as bench:
        bench.set_parameter(name, limit)
        bench.take_off()
        bench.streaming[1] = mavlink.MAVLink_set_position_target_local_ned_message(
            0, 1, 1, mavlink.MAV_FRAME_LOCAL_NED, 0b1101_1100_0111, 0, 0, 0, *velocity, *[0.0] * 5
        )
        bench.run(0.3)
        assert bench.command(*OFFBOARD) == ACCEPTED
        assert bench.run(10.0, lambda: bench.mode_of() == "AUTO.LOITER")
        assert abs(bench.position()[axis]) == pytest.approx(limit, abs=0.3)
        bench.run(0.2)
        assert name in bench.texts()


def test_mission_and_arming_beyond_the_fence_are_refused():
    with FreeBench() as bench:
        bench.run(0.5)
        upload(bench, PlanType.FENCE, polygon(IN_POLYGON))
        items = [
            item(mavlink.MAV_CMD_NAV_TAKEOFF, up=5.0)._replace(x=0, y=0),
            item(mavlink.MAV_CMD_NAV_WAYPOINT, 5.0, 0.0, 5.0),
            item(mavlink.MAV_CMD_NAV_WAYPOINT, 15.0, 0.0, 5.0),
        ]
        bench.vehicles[0].aircraft.take_mission(items, 0, lambda index: None)
        assert bench.command(*mode(px4.AutoMode.MISSION)) == DENIED
        assert "item 2 is beyond the fence: outside the inclusion areas" in bench.texts()
        bench.vehicles[0].aircraft.take_mission(items[:2], 0, lambda index: None)
        assert bench.command(*mode(px4.AutoMode.MISSION)) == ACCEPTED
        upload(bench, PlanType.FENCE, circle(OUT_OF_CIRCLE, 0.0, 1.0, 3.0))
        assert bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        assert "Arming denied: beyond the fence: in an exclusion area" in bench.texts()


def test_return_point_of_a_fence_and_termination_are_refused():
    with FreeBench() as bench:
        bench.run(0.5)
        assert upload(bench, PlanType.FENCE, [item(5000, 1.0, 1.0)]) == mavlink.MAV_MISSION_UNSUPPORTED
        assert "return point is not flown to" in bench.texts()
        action = px4.parameter_to_wire(4, mavlink.MAV_PARAM_TYPE_INT32)
        bench.send(mavlink.MAVLink_param_set_message(1, 1, b"GF_ACTION", action, mavlink.MAV_PARAM_TYPE_INT32))
        assert bench.vehicles[0].parameters["GF_ACTION"] == 2


def test_vehicle_returns_to_the_nearest_of_home_and_rally_points():
    with FreeBench() as bench:
        bench.set_parameter("RTL_RETURN_ALT", 6.0)
        points = [item(5100, 16.0, 10.0, 8.0), item(5100, 40.0, 40.0, 3.0)]
        assert upload(bench, PlanType.RALLY, points) == mavlink.MAV_MISSION_ACCEPTED
        bench.take_off()
        bench.vehicles[0].autopilot.go_to((20.0, 0.0, -5.0), NAN, NAN, bench.now)
        bench.run(8.0)
        assert bench.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH) == ACCEPTED
        assert bench.run(40.0, lambda: not bench.armed())
        assert bench.position() == pytest.approx((16.0, 10.0, -0.02), abs=0.3)
        assert -bench.path()[:, 2].min() == pytest.approx(8.0, abs=0.4)  # as high as the rally point
        bench.run(1.0)
        bench.take_off()
        bench.vehicles[0].autopilot.go_to((4.0, 3.0, -5.0), NAN, NAN, bench.now)
        bench.run(8.0)
        home = bench.vehicles[0].autopilot.home
        assert math.hypot(home[0] - 16.0, home[1] - 10.0) < 0.5  # where it was armed last
        upload(bench, PlanType.RALLY, [item(5100, 0.0, 0.0, 4.0)])
        bench.command(mavlink.MAV_CMD_NAV_RETURN_TO_LAUNCH)
        assert bench.run(40.0, lambda: not bench.armed())
        assert bench.position()[:2] == pytest.approx((0.0, 0.0), abs=0.3)


def test_point_in_areas_agrees_with_shapely():
    import shapely

    rng = np.random.default_rng(5)
    star = [(math.cos(a) * r, math.sin(a) * r) for a, r in zip(np.arange(10) * 0.6, [10.0, 4.0] * 5, strict=True)]
    area, ring = shapely.Polygon(star), Polygon(tuple(star))
    for north, east in rng.uniform(-11.0, 11.0, (2000, 2)):
        assert ring.contains(north, east) == area.contains(shapely.Point(north, east))
    two = Fence((Circle((0.0, 0.0), 2.0), Circle((10.0, 0.0), 2.0)), (Circle((10.0, 0.0), 1.0),))
    assert two.breach(1.9, 0.0) is None and two.breach(11.5, 0.0) is None
    assert two.breach(5.0, 0.0) == "outside the inclusion areas" and two.breach(10.5, 0.0) == "in an exclusion area"


def test_place_of_an_uploaded_corner_is_that_of_the_local_frame():
    with FreeBench() as bench:
        upload(bench, PlanType.FENCE, polygon(IN_POLYGON))
        [area] = bench.vehicles[0].autopilot.state.fence.inclusions
        assert np.array(area.corners) == pytest.approx(np.array(SQUARE), abs=0.02)
        assert FRAME.local(*FRAME.geodetic(12.0, -12.0, 0.0))[:2] == pytest.approx((12.0, -12.0), abs=1e-6)
