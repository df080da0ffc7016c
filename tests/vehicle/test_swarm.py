"""The swarm in one process, without sockets."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from scripted_ground import ScriptedGround, exchange

from gcs.config import read_system
from gcs.mavlink import px4
from gcs.mission.model import Home, Obstacle
from gcs.mission.motion import HarmonicMotion, LinearMotion
from gcs.record.reader import read_table
from idc_controller.geometry.shapes import Pole, Sphere, Wall
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.errors import SimulationError, UnsupportedWorld
from vehicle_sim.world.truth_log import TruthLog

CONFIG = read_system()
OBSTACLES = (
    Obstacle("swinging", (6.0, 0.0, -5.0), Sphere(0.5), motion=HarmonicMotion((1.5, 0.0, 0.0), 1.0, math.pi / 2)),
    Obstacle("drifting", (-8.0, 3.0, -6.0), Pole(0.2, 12.0), motion=LinearMotion((0.5, -0.25, 0.0))),
    Obstacle("standing", (0.0, 20.0, -2.0), Wall((4.0, 0.5, 4.0), math.radians(30.0))),
)


def ground_of(config, **settings):
    system = config.parameters()
    addresses = [("uav", i) for i in range(1, system.number_of_uavs + 1)]
    return ScriptedGround(addresses, float(system.hover_thrust.mean()), system.thrust_max, **settings)


def flight(folder, config=CONFIG, seed=1, obstacles=(), **settings):
    """Lift-off, then link loss until all is at rest: (swarm's vehicles, ground, rows of truth.csv)."""
    ground = ground_of(config)
    with Swarm(config, seed=seed, obstacles=obstacles, **settings) as swarm:
        swarm.record(TruthLog(folder, config.team.vehicles))
        exchange(swarm, ground, 10.0, lambda: ground.finished)
        assert ground.finished
        left = swarm.time
        assert not swarm.at_rest
        exchange(swarm, ground, left + 30.0, lambda: swarm.at_rest)
        assert swarm.at_rest
        assert swarm.world.touching_ground()
        take_off = swarm.take_off_time
        vehicles = swarm.vehicles
    return vehicles, ground, read_table(folder / "truth.csv"), take_off


@pytest.fixture(scope="module")
def flown(tmp_path_factory):
    folder = tmp_path_factory.mktemp("flown")
    return folder, *flight(folder, obstacles=OBSTACLES)


@pytest.mark.slow
def test_vehicles_hold_then_land_after_link_loss(flown):
    _, vehicles, ground, truth, _ = flown
    assert not any(vehicle.autopilot.armed for vehicle in vehicles)
    altitude = -truth["payload_z_m"]
    assert altitude[0] == pytest.approx(0.30, abs=0.01)
    assert altitude[-1] == pytest.approx(0.30, abs=0.01)
    assert 0.9 < altitude.max() < 2.0
    texts = " ".join(message.text for message in ground.of_type("STATUSTEXT"))
    assert "Set-points lost" in texts
    assert "Touch-down" in texts


@pytest.mark.slow
def test_payload_stays_level_without_contacts(flown):
    _, _, _, truth, _ = flown
    assert not truth["contacts"].any()
    tilt = 2.0 * np.hypot(truth["payload_qx"], truth["payload_qy"]).max()
    assert tilt < math.radians(5.0)


@pytest.mark.slow
def test_truth_rows_are_on_a_grid_of_20_ms_from_zero(flown):
    _, _, _, truth, _ = flown
    assert truth["time_s"].tolist() == [k / 50 for k in range(len(truth))]


@pytest.mark.slow
def test_obstacles_start_moving_at_take_off(flown):
    folder, _, _, truth, take_off = flown
    obstacles = read_table(folder / "obstacles.csv")
    assert 1.0 < take_off < 3.0
    t = np.maximum(truth["time_s"] - take_off, 0.0)
    sphere, pole, wall = (obstacles[obstacles["shape"] == shape] for shape in ("sphere", "pole", "wall"))
    assert sphere["time_s"].tolist() == pole["time_s"].tolist() == truth["time_s"].tolist()
    assert sphere["x_m"] == pytest.approx(6.0 + 1.5 * np.cos(t), abs=1e-9)
    assert pole["x_m"] == pytest.approx(-8.0 + 0.5 * t, abs=1e-9)
    assert pole["y_m"] == pytest.approx(3.0 - 0.25 * t, abs=1e-9)
    assert {*pole[["z_m", "size_z_m", "radius_m"]].tolist()} == {(-6.0, 12.0, 0.2)}
    # It stands: one row.
    assert wall[["time_s", "x_m", "y_m", "size_y_m"]].tolist() == [(0.0, 0.0, 20.0, 0.5)]
    assert wall["yaw_rad"] == pytest.approx(math.radians(30.0))


@pytest.mark.slow
def test_telemetry_carries_newest_sample(flown):
    _, _, ground, _, _ = flown
    assert sorted(ground.stamps) == [1, 2, 3, 4]
    for stamps in ground.stamps.values():
        # The first answers the first datagram; from then on each is stamped with its own time.
        assert len(stamps) > 8 * CONFIG.rates.telemetry
        assert all(stamp == round(now * 1e3) for stamp, now in stamps)
        assert {b - a for (a, _), (b, _) in itertools.pairwise(stamps[1:])} == {1000 // CONFIG.rates.telemetry}


@pytest.mark.slow
def test_every_vehicle_forwards_the_payload_unit_to_the_ground_that_calls_in(flown):
    _, _, ground, _, _ = flown
    samples = {}
    for sender, message in ground.of_payload:
        if message.get_type() == "LOCAL_POSITION_NED":
            samples.setdefault(message.time_boot_ms, set()).add((sender, message.x, message.z))
    complete = [of for of in samples.values() if len(of) == 4]
    assert len(complete) > 8 * CONFIG.rates.telemetry
    for of in complete:  # one unit, so one sample for all four
        assert len({(x, z) for _, x, z in of}) == 1


@pytest.mark.slow
def test_noise_has_standard_deviation_of_system_file(flown):
    _, _, ground, truth, _ = flown
    true = {round(row["time_s"] * 1e3): row for row in truth}
    uav, payload = [], []
    for message in ground.of_type("LOCAL_POSITION_NED"):
        row = true.get(message.time_boot_ms)
        if row is None:
            continue
        if message.get_srcSystem() == px4.PAYLOAD_UNIT_SYSTEM:
            payload += [message.vx - row["payload_vx_mps"], message.vz - row["payload_vz_mps"]]
        else:
            i = message.get_srcSystem()
            uav += [message.x - row[f"uav{i}_x_m"], message.z - row[f"uav{i}_z_m"]]
    # Of some 2600 and 660 samples: a deviation is known to 1 / sqrt(2 n) = 1.4 and 2.8 %, the mean to 0.0004 m.
    assert np.std(uav) == pytest.approx(CONFIG.sensors.position, rel=0.05)
    assert np.std(payload) == pytest.approx(CONFIG.sensors.payload_velocity, rel=0.1)
    assert abs(np.mean(uav)) < 0.002


@pytest.mark.slow
def test_flight_repeats_to_the_byte_with_same_seed_only(flown, tmp_path):
    folder = flown[0]
    flight(tmp_path / "again", obstacles=OBSTACLES)
    flight(tmp_path / "other", obstacles=OBSTACLES, seed=2)
    for name in ("truth.csv", "obstacles.csv"):
        assert (tmp_path / "again" / name).read_bytes() == (folder / name).read_bytes()
    assert (tmp_path / "other" / "truth.csv").read_bytes() != (folder / "truth.csv").read_bytes()


@pytest.mark.slow
@pytest.mark.parametrize("vehicles", [3, 6])
def test_teams_of_other_sizes_fly_and_land(tmp_path, vehicles):
    _, _, truth, _ = flight(tmp_path, CONFIG.with_vehicles(vehicles))
    assert not truth["contacts"].any()


def test_payload_mass_of_world_differs_from_nominal():
    heavier = replace(CONFIG, world=replace(CONFIG.world, payload_mass_factor=1.1))
    with Swarm(heavier, seed=1) as swarm:
        assert swarm.world.parameters.m_0 == pytest.approx(1.1 * CONFIG.payload.mass)


def test_contacts_between_two_rows_are_counted_in_the_second(tmp_path):
    # A ball that passes through the discs of the waiting team as soon as it lifts off.
    ball = Obstacle("ball", (0.5, 0.5, -3.75), Sphere(0.1), motion=LinearMotion((0.0, 0.0, -30.0)))
    ground = ground_of(CONFIG)
    with Swarm(CONFIG, seed=1, obstacles=(ball,)) as swarm:
        swarm.record(TruthLog(tmp_path, 4))
        exchange(swarm, ground, 3.0, lambda: ground.finished)
    assert read_table(tmp_path / "truth.csv")["contacts"].any()


def test_home_is_that_of_the_mission():
    with Swarm(CONFIG, seed=1, home=Home(-33.5, 151.25, 12.0)) as swarm:
        ground = ground_of(CONFIG)
        exchange(swarm, ground, 2.5)
        (message,) = ground.of_type("HOME_POSITION", 1)[:1]
        assert (message.latitude, message.longitude, message.altitude) == (-335000000, 1512500000, 12000)


def test_swarm_without_peer_has_no_timer():
    with Swarm(CONFIG, seed=1) as swarm:
        assert swarm.next_timer() is None
        assert swarm.at_rest


def test_time_advances_in_whole_physics_steps():
    with Swarm(CONFIG, seed=1) as swarm:
        swarm.advance_to(0.0131)
        assert swarm.time == 0.012
        swarm.advance_to(0.005)
        assert swarm.time == 0.012
        swarm.advance_to(0.02)
        assert swarm.time == 0.02
        assert swarm.vehicles[0].autopilot.state.navigation.estimate.time == 0.02


def test_truth_is_written_50_times_a_second_or_more_at_any_physics_rate(tmp_path):
    odd = replace(CONFIG, rates=replace(CONFIG.rates, physics=520, onboard=260, telemetry=40, control=20))
    with Swarm(odd, seed=1) as swarm:
        swarm.record(TruthLog(tmp_path, 4))
        swarm.advance_to(1.0)
    assert read_table(tmp_path / "truth.csv")["time_s"].tolist() == [k * 10 / 520 for k in range(53)]


def test_fault_injector_acts_on_samples_and_datagrams():
    class Disturbed(FaultInjector):
        def disturbs_samples(self, vehicle):
            return vehicle == 2

        def own_sample(self, vehicle, sample):
            return None if vehicle == 2 else sample

        def to_vehicle(self, vehicle, arriving, now):
            return [] if vehicle == 3 else arriving

        def from_vehicle(self, vehicle, leaving, now):
            return [] if vehicle == 4 else leaving

    with Swarm(CONFIG, seed=1, faults=Disturbed()) as swarm:
        ground = ground_of(CONFIG)
        exchange(swarm, ground, 0.25)
        assert swarm.vehicles[1].autopilot.state.navigation.estimate is None
        received = {i: len([m for m in ground.messages if m.get_srcSystem() == i]) for i in (1, 2, 3, 4)}
        assert received[1] > received[2] > received[3] == received[4] == 0  # all, all but samples, nothing


def test_failed_construction_of_swarm_closes_world():
    with pytest.raises(UnsupportedWorld):
        Swarm(CONFIG.with_vehicles(16), seed=1)
    twice = (Obstacle("a", (0.0, 0.0, -9.0), Sphere(0.5)), Obstacle("a", (0.0, 5.0, -9.0), Sphere(0.5)))
    with pytest.raises(SimulationError, match="the name is taken"):
        Swarm(CONFIG, seed=1, obstacles=twice)
