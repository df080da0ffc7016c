"""Free vehicles at once: each on its own, recorded, and the same to the byte with the same seed."""

import math

import numpy as np
import pymavlink.dialects.v20.common as mavlink
import pytest
from free_bench import GROUND, FreeBench, config_of, item, mode

from gcs.errors import UnusableInput
from gcs.mavlink import px4
from gcs.mission.model import Fault, Obstacle
from gcs.record.reader import read_table
from gcs.record.run_data import read_run
from gcs.record.tables import truth_columns
from idc_controller.geometry.shapes import Wall
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.free_world import FreeWorld
from vehicle_sim.world.truth_log import TruthLog

CORNERS = ((8.0, 0.0), (8.0, 8.0), (0.0, 8.0))


def four_missions(folder, seed=1):
    """Four vehicles fly squares of their own at heights of their own, and land; returns what each reached."""
    reached = {i: [] for i in range(1, 5)}
    with FreeBench(4, seed) as bench:
        bench.swarm.record(TruthLog(folder, 4, payload=False))
        bench.run(0.5)
        for i, vehicle in enumerate(bench.vehicles, start=1):
            up = 2.0 + 2.0 * i
            places = [item(mavlink.MAV_CMD_NAV_WAYPOINT, x, y + 2.0 * (i - 1), up) for x, y in CORNERS]
            items = [item(mavlink.MAV_CMD_NAV_TAKEOFF, up=up)._replace(x=0, y=0), *places]
            items.append(item(mavlink.MAV_CMD_NAV_LAND, 0.0, 2.0 * (i - 1)))
            vehicle.aircraft.take_mission(items, 0, reached[i].append)
            assert bench.command(*mode(px4.AutoMode.MISSION), vehicle=i) == mavlink.MAV_RESULT_ACCEPTED
            assert bench.command(mavlink.MAV_CMD_COMPONENT_ARM_DISARM, 1, vehicle=i) == mavlink.MAV_RESULT_ACCEPTED
        assert bench.run(70.0, lambda: not any(bench.armed(i) for i in reached))
        datagrams = bench.swarm.datagrams_to_send(bench.now)
    return reached, datagrams


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("free")
    return folder, *four_missions(folder)


def test_four_fly_missions_of_their_own(flown):
    folder, reached, _ = flown
    assert reached == {i: [0, 1, 2, 3, 4] for i in range(1, 5)}
    truth = read_table(folder / "truth.csv")
    for i in range(1, 5):
        x, y, z = (truth[f"uav{i}_{axis}_m"] for axis in "xyz")
        for north, east in CORNERS:
            away = np.hypot(np.hypot(x - north, y - east - 2.0 * (i - 1)), z + 2.0 + 2.0 * i)
            assert away.min() < 2.1  # NAV_ACC_RAD
        assert (x[-1], y[-1], z[-1]) == pytest.approx((0.0, 2.0 * (i - 1), -0.02), abs=0.3)
    assert not truth["contacts"].any()


def test_truth_has_columns_of_the_vehicles_alone(flown):
    folder, *_ = flown
    truth = read_table(folder / "truth.csv")
    assert truth.dtype.names == truth_columns(4, payload=False)
    assert not any(name.startswith("payload") for name in truth.dtype.names)
    assert np.diff(truth["time_s"]).max() <= 0.02 + 1e-9
    assert not (folder / "forces.csv").exists()
    modes = read_table(folder / "modes.csv")
    assert {*modes["mode"]} >= {"AUTO.MISSION", "AUTO.LOITER"}


def test_report_of_vehicles_without_a_payload_is_refused(flown):
    with pytest.raises(UnusableInput, match="vehicles without a payload flew here"):
        read_run(flown[0])


def test_same_seed_gives_the_same_bytes(flown, tmp_path):
    folder, _, datagrams = flown
    again = four_missions(tmp_path / "again")[1]
    assert again == datagrams
    for name in ("truth.csv", "modes.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes()


def test_another_seed_gives_another_flight():
    paths = []
    for seed in (1, 2):
        with FreeBench(1, seed) as bench:
            bench.take_off(2.0)
            paths.append(bench.path()[-1])
    assert not np.array_equal(*paths)


def test_more_vehicles_than_a_payload_allows_stand_in_a_row():
    with Swarm(config_of(20), seed=1, free=True) as swarm:
        swarm.advance_to(0.5)
        states = swarm.world.states()
        assert states[:, :3] == pytest.approx(np.array([(0.0, 2.0 * i, -0.02) for i in range(20)]), abs=0.01)
        assert swarm.at_rest


def test_velocity_is_the_derivative_of_the_position():
    system = config_of(1)
    with FreeWorld(system.uav, 1) as world:
        states = []
        for k in range(500):
            world.step([12.0 + 6.0 * math.sin(0.05 * k)], [(0.0, 0.0, 0.0)])
            states.append(world.states()[0].copy())
        states = np.array(states)
        z, v_z = states[:, 2], states[:, 9]
        assert v_z[100:-1] == pytest.approx((z[101:] - z[99:-2]) * 250.0, abs=1e-3)
        assert v_z[-1] == pytest.approx(
            9.81 - np.mean([12.0 + 6.0 * math.sin(0.05 * k) for k in range(500)]) / 0.7, abs=0.05
        )


def test_body_torque_turns_as_the_inertia_says():
    system = config_of(1)
    with FreeWorld(system.uav, 1) as world:
        for _ in range(250):
            world.step([10.0], [(0.0, 0.0, 0.001)])
        assert world.states()[0, 12] == pytest.approx(0.5 * 0.001 / 0.01, rel=0.02)


def test_vehicles_meet_obstacles():
    wall = Obstacle("wall", (5.0, 0.0, -5.0), Wall((0.4, 10.0, 10.0), 0.0))
    with FreeBench(obstacles=(wall,)) as bench:
        bench.take_off(3.0)
        bench.vehicles[0].autopilot.go_to((15.0, 0.0, -3.0), float("nan"), float("nan"), bench.now)
        assert bench.run(10.0, lambda: bench.swarm.world.contacts().pairs > 0)
        assert bench.position()[0] == pytest.approx(4.5, abs=0.1)
        bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3))
        bench.run(1.0)
        counts = [m.clipping_0 for _, _, m in bench.messages if m.get_type() == "VIBRATION"]
        assert max(counts) > 0
        assert any(m.get_type() == "OBSTACLE_DISTANCE" and min(m.distances) < 100 for _, _, m in bench.messages)


def test_faults_of_a_vehicle_act():
    fault = Fault("bias", 0.0, vehicles=(2,), settings={"channel": "position", "amount": -1.5})
    config = config_of(2)
    with FreeBench(2, faults=FaultInjector((fault,), 1, config)) as bench:
        bench.take_off(4.0)
        bench.messages.clear()
        bench.run(1.0)
        last = {i: m for _, i, m in bench.messages if m.get_type() == "LOCAL_POSITION_NED"}
        assert last[1].z == pytest.approx(bench.position(1)[2], abs=0.1)
        assert last[2].z == pytest.approx(bench.position(2)[2] - 1.5, abs=0.1)


def test_each_vehicle_is_answered_alone():
    with FreeBench(3) as bench:
        bench.run(0.2)
        for _ in range(2):  # the second shows that it gets what is sent to it
            bench.send(mavlink.MAVLink_heartbeat_message(6, 8, 0, 0, 4, 3), vehicle=2)
            bench.run(0.5)
        bench.messages.clear()
        bench.run(1.5)
        assert {i for _, i, _ in bench.messages} == {2}
        assert {message.get_srcSystem() for _, _, message in bench.messages} == {2}
        assert GROUND in [address for _, _, address in bench.swarm.datagrams_to_send(bench.now + 1.0)]
