"""Orbits of a free vehicle: MAV_CMD_DO_ORBIT."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import FRAME, NAN, FreeBench, item, mode

from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Orbit, Place

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
ORBIT, STATUS = mavlink.MAV_CMD_DO_ORBIT, mavlink.MAVLINK_MSG_ID_ORBIT_EXECUTION_STATUS
CENTRE = (10.0, 4.0)


def orbit(bench, radius=6.0, speed=3.0, heading=0, angle=math.inf, centre=CENTRE, up=6.0):
    place = Place(*FRAME.geodetic(*centre, -up))
    return bench.vehicles[0].aircraft.orbit(Orbit(radius, speed, heading, angle, place), bench.now)


def turned(path, centre=CENTRE):
    """Return by which angle (rad, clockwise) a path goes round the centre."""
    angles = np.unwrap(np.arctan2(path[:, 1] - centre[1], path[:, 0] - centre[0]))
    return angles[-1] - angles[0]


@pytest.mark.parametrize("radius", [6.0, -6.0])
def test_circle_is_flown_with_radius_speed_and_direction_and_its_status_sent(radius):
    with FreeBench() as bench:
        bench.take_off()
        assert orbit(bench, radius).result == ACCEPTED
        bench.run(8.0)
        assert bench.mode_of() == "POSCTL.ORBIT"
        began = len(bench.track)
        bench.run(10.0)
        path = bench.path()[began:]
        away = np.hypot(path[:, 0] - CENTRE[0], path[:, 1] - CENTRE[1])
        assert away == pytest.approx(6.0, abs=0.4)
        assert np.hypot(path[:, 7], path[:, 8]).mean() == pytest.approx(3.0, abs=0.2)
        assert path[:, 2] == pytest.approx(-6.0, abs=0.2)
        assert turned(path) == pytest.approx(math.copysign(5.0, radius), abs=0.3)  # 10 s of 3 m/s on 6 m
        status = bench.requested(STATUS)
        assert status.radius == radius
        assert FRAME.local(status.x * 1e-7, status.y * 1e-7, status.z)[:2] == pytest.approx(CENTRE, abs=0.02)
        assert bench.command(*mode(px4.AutoMode.LOITER)) == ACCEPTED
        bench.run(4.0)
        place = bench.position().copy()
        bench.run(2.0)
        assert bench.position() == pytest.approx(place, abs=0.15)
        assert bench.requested(STATUS) is None


@pytest.mark.parametrize(("heading", "offset"), [(0, math.pi), (3, math.pi / 2)])
def test_vehicle_looks_to_the_centre_or_along_the_circle(heading, offset):
    with FreeBench() as bench:
        bench.take_off()
        assert orbit(bench, heading=heading).result == ACCEPTED
        bench.run(12.0)
        for _ in range(5):
            bench.run(1.0)
            x, y, _ = bench.position()
            outwards = math.atan2(y - CENTRE[1], x - CENTRE[0])
            assert math.remainder(bench.heading() - outwards - offset, 2 * math.pi) == pytest.approx(0.0, abs=0.25)


def test_initial_heading_is_kept():
    with FreeBench() as bench:
        bench.take_off()
        assert orbit(bench, heading=1).result == ACCEPTED
        bench.run(12.0)
        assert bench.heading() == pytest.approx(0.0, abs=0.05)


def test_orbit_of_an_angle_ends_in_a_hold():
    with FreeBench() as bench:
        bench.take_off()
        assert orbit(bench, angle=math.pi, speed=2.0).result == ACCEPTED
        assert bench.run(30.0, lambda: bench.mode_of() == "AUTO.LOITER")
        start = np.array(CENTRE) * (1.0 - 6.0 / math.hypot(*CENTRE))
        opposite = 2.0 * np.array(CENTRE) - start
        assert bench.position()[:2] == pytest.approx(opposite, abs=1.0)


def test_orbit_without_a_place_is_about_where_it_is():
    with FreeBench() as bench:
        bench.take_off()
        bench.run(1.5)
        assert bench.command(ORBIT, 5.0, 2.0, NAN, NAN, NAN, NAN, NAN) == ACCEPTED
        bench.run(8.0)
        began = len(bench.track)
        bench.run(6.0)
        path = bench.path()[began:]
        assert np.hypot(path[:, 0], path[:, 1]) == pytest.approx(5.0, abs=0.5)
        assert path[:, 2] == pytest.approx(-5.0, abs=0.2)


def test_orbit_that_would_not_be_flown_is_refused_with_the_reason():
    with FreeBench() as bench:
        bench.run(0.5)
        assert orbit(bench).text == "Orbit denied: not flying"
        bench.take_off()
        for radius, speed, words in (
            (0.5, 1.0, "outside 1 .. 1000 m"),
            (3.0, 5.0, "on this circle the limit is 3 m/s"),
            (500.0, 15.0, "the limit is 12 m/s"),
        ):
            answer = orbit(bench, radius, speed)
            assert answer.result == DENIED and words in answer.text
        bench.vehicles[0].aircraft.take_fence([item(5004, 16.0, 4.0, 0.0, 2.0)])
        assert "beyond the fence: in an exclusion area" in orbit(bench).text
        assert bench.mode_of() == "AUTO.LOITER"
        assert orbit(bench, centre=(0.0, 0.0)).result == ACCEPTED
        bench.run(1.0)
        assert bench.command(mavlink.MAV_CMD_DO_CHANGE_SPEED, 1, 2.0) == mavlink.MAV_RESULT_TEMPORARILY_REJECTED
        assert "POSCTL.ORBIT flies the speed of its command" in bench.texts()
