"""Numbers and places of mission items against the libraries that have them."""

import math

import pymap3d
from hypothesis import given, settings
from hypothesis import strategies as st
from pymap3d.haversine import anglesep
from pymavlink.dialects.v20 import ardupilotmega, common

from gcs.mission.commands import FENCE_AND_RALLY, LAST_NAVIGATION, LEFT_OUT, Command, Frame, command_name, frame_name
from gcs.mission.geodesy import angle_between, north_east

COMMANDS = ardupilotmega.enums["MAV_CMD"]
latitudes, longitudes = st.floats(-89.0, 89.0), st.floats(-180.0, 180.0)


def test_commands_have_the_numbers_of_the_dialects() -> None:
    named = {command.value: command.name for command in Command if command is not Command.CONDITION_GATE}
    assert named == {number: COMMANDS[number].name.removeprefix("MAV_CMD_") for number in named}
    assert LAST_NAVIGATION == common.MAV_CMD_NAV_LAST
    fence = {number for number, entry in COMMANDS.items() if entry.name.startswith("MAV_CMD_NAV_FENCE")}
    assert fence | {common.MAV_CMD_NAV_RALLY_POINT} == FENCE_AND_RALLY


def test_commands_left_out_are_of_the_dialects_and_move_nothing() -> None:
    names = {COMMANDS[number].name.removeprefix("MAV_CMD_") for number in LEFT_OUT}
    moving = ("NAV_", "CONDITION_", "DO_JUMP", "DO_CHANGE", "DO_REPOSITION", "DO_GO_AROUND", "DO_PARACHUTE")
    assert {name for name in names if name.startswith(moving)} == {"NAV_ROI", "CONDITION_YAW"}
    assert not LEFT_OUT & {*Command}


def test_frames_have_the_numbers_of_the_common_dialect() -> None:
    assert {f"MAV_FRAME_{frame.name}": frame for frame in Frame}.items() <= {
        entry.name: number for number, entry in common.enums["MAV_FRAME"].items()
    }.items()


def test_names_of_other_commands_and_frames_come_from_the_dialect() -> None:
    assert command_name(16) == "NAV_WAYPOINT"
    assert command_name(4501) == "CONDITION_GATE"
    assert command_name(2000) == "IMAGE_START_CAPTURE"
    assert command_name(208) == "DO_PARACHUTE"
    assert command_name(42702) == "NAV_SCRIPT_TIME"
    assert command_name(31999) == "command 31999"
    assert frame_name(1) == "frame 1, LOCAL_NED"
    assert frame_name(99) == "frame 99"


@settings(deadline=None, derandomize=True)
@given(latitudes, longitudes, st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(-400.0, 5000.0))
def test_places_about_home_are_those_of_pymap3d(lat: float, lon: float, north: float, east: float, h: float) -> None:
    there = (lat + north, lon + east)
    expected = pymap3d.geodetic2ned(*there, h, lat, lon, h)[:2]
    assert math.dist(north_east(*there, lat, lon, h), expected) < 1e-8  # m


@settings(deadline=None, derandomize=True)
@given(latitudes, longitudes, latitudes, longitudes)
def test_angle_between_places_is_that_of_pymap3d(lat: float, lon: float, other_lat: float, other_lon: float) -> None:
    expected = float(anglesep(lon, lat, other_lon, other_lat))
    assert math.isclose(angle_between(lat, lon, other_lat, other_lon), expected, abs_tol=1e-6)
