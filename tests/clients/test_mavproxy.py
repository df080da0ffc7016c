"""MAVProxy and vehicles without a payload, and one that carries a payload: what it is told, and what then happens."""

import numpy as np
import pytest
from client_swarm import FRAME
from mavproxy_client import mavproxy

pytestmark = pytest.mark.slow

TARGET = (3.0, 1.0, 2.5)  # m, north, east, up
PLAN = """QGC WPL 110
0	1	0	16	0	0	0	0	{0[0]:.8f}	{0[1]:.8f}	488	1
1	0	3	22	0	0	0	0	{0[0]:.8f}	{0[1]:.8f}	2	1
2	0	3	16	0	0.3	0	0	{1[0]:.8f}	{1[1]:.8f}	2	1
3	0	2	20	0	0	0	0	0	0	0	1
"""


def accepted(command):
    return rf"COMMAND_ACK: {command}: ACCEPTED"


def set_parameter(program, name, value):
    """Set a parameter; MAVProxy sends it later, and does not say when it was set."""
    program.type(f"param set {name} {value}")
    while float(program.command(f"param fetch {name}", rf"{name} = (\S+)")[1]) != value:
        pass


def test_mavproxy_flies_a_vehicle_by_commands(free_swarm, tmp_path):
    latitude, longitude, _ = FRAME.geodetic(*TARGET[:2], 0.0)
    with mavproxy(free_swarm.sdk_port(1), tmp_path) as program:
        program.command("arm throttle", "^ARMED$|> ARMED$")
        # It sends the height as an altitude above the sea, which is below the ground here.
        program.command("takeoff 2", "Mode TAKEOFF")
        program.until("Mode LOITER")
        program.command(f"guided {latitude:.7f} {longitude:.7f} {TARGET[2]}", accepted("DO_REPOSITION"))
        program.command("setspeed 1", accepted("DO_CHANGE_SPEED"))
        began = free_swarm.now()
        program.type("watch GLOBAL_POSITION_INT")
        while free_swarm.track(1).nearest(*TARGET) > 0.3:
            program.until("< GLOBAL_POSITION_INT {")
        program.command("pause", accepted("DO_PAUSE_CONTINUE"))
        flown = free_swarm.track(1, began)
        program.command("long DO_SET_MODE 1 4 5", "Mode RTL")  # its mode RTL raises an error with PX4's modes
        program.until("DISARMED")
        printed = "\n".join(program.printed)
    assert "Traceback" not in printed
    track = free_swarm.track(1)
    assert track.height.max() == pytest.approx(4.0, abs=0.2)  # RTL: near home twice NAV_ACC_RAD
    assert np.linalg.norm(flown.velocity[:, :2], axis=1).max() < 1.4
    assert np.linalg.norm(track.position[-1, :2]) < 0.3 and track.height[-1] < 0.05
    assert free_swarm.modes(1) == ["AUTO.LOITER", "AUTO.TAKEOFF", "AUTO.LOITER", "AUTO.RTL", "AUTO.LOITER"]


def test_mavproxy_loads_a_mission_file_and_the_vehicle_flies_it(free_swarm, tmp_path):
    home, point = FRAME.geodetic(0.0, 2.0, 0.0)[:2], FRAME.geodetic(-3.0, 2.0, 0.0)[:2]
    (tmp_path / "plan.waypoints").write_text(PLAN.format(home, point))
    began = free_swarm.now()
    with mavproxy(free_swarm.sdk_port(2), tmp_path) as program:
        program.command("wp load plan.waypoints", r"Loaded 4 (waypoints|mission items)")
        program.until(r"Flight plan received|Sent waypoint 3|MISSION_ACK|ACCEPTED")
        program.command("wp list", "Requesting 4 waypoints")
        program.command("long MISSION_START", accepted("MISSION_START"))
        program.until("DISARMED")
    track = free_swarm.track(2, began)
    assert track.nearest(-3.0, 2.0, 2.0) < 0.6
    assert np.linalg.norm(track.position[-1, :2] - (0.0, 2.0)) < 0.3 and track.height[-1] < 0.05


def test_mavproxy_reads_and_sets_parameters(free_swarm, tmp_path):
    with mavproxy(free_swarm.sdk_port(2), tmp_path) as program:
        program.command("param show MPC_XY_CRUISE", r"MPC_XY_CRUISE +5\.0")
        set_parameter(program, "MPC_XY_CRUISE", 3.5)
        program.command("param set CLFT_MASS 1", "CLFT_MASS: read-only")
        program.command("param set MPC_XY_CRUISE 300", "MPC_XY_CRUISE: 300 is outside")
        program.command("param set NO_SUCH 1", "Unable to find parameter 'NO_SUCH'")


@pytest.mark.long  # the refusals themselves: tests/services
def test_mavproxy_is_refused_what_one_vehicle_on_a_payload_cannot_do(team, tmp_path):
    with mavproxy(team.sdk_port(2), tmp_path) as program:
        for command, name in (
            ("takeoff 2", "NAV_TAKEOFF"), ("guided 47.3977 8.5456 3", "DO_REPOSITION"),
            ("long MISSION_START", "MISSION_START"), ("setspeed 2", "DO_CHANGE_SPEED"),
            ("long NAV_RETURN_TO_LAUNCH", "NAV_RETURN_TO_LAUNCH"),
        ):  # fmt: skip
            program.command(command, "one vehicle alone would tip the payload")
            program.until(rf"COMMAND_ACK: {name}: DENIED")
        program.command("arm throttle", "^ARMED$|> ARMED$")
        program.command("disarm", "DISARMED")
    assert team.armed(2) == [False, True, False]
    assert team.payload_moved() < 0.01 and team.track(2).thrust.max() == 0.0
