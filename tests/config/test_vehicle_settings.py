"""Numbers of vehicles and world that follow from a key of the system file: the key is changed, behaviour follows."""

from dataclasses import replace

import numpy as np
import pytest
from onboard import step_alone
from test_settings_followed import system
from vehicle_bench import ACCEPTED, ARM, GROUND, OFFBOARD, Bench, attitude_target
from world_runs import run, uav_array

from gcs.config import read_system
from gcs.config.tables import AirSettings, BodySettings, CradleSettings, PadSettings, RestSettings, WorldConfig
from gcs.config.vehicle_settings import SetpointSettings, StreamIntervals
from gcs.mission.model import Fault
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.autopilot.vehicle_parameters import vehicle_parameters
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.multibody import urdf_text
from vehicle_sim.world.sensors import Measurement
from vehicle_sim.world.truth_log import TruthLog
from vehicle_sim.world.world import World

LEVEL = (1.0, 0.0, 0.0, 0.0)
STEADY = [(0.0, 0.0, 0.0)] * 4


def stop_of(config):
    """Stop of a vehicle at 3 m/s without set-points and stop plan: the time of the loss (s), and its plan."""
    airframe = Airframe.of_system(config.parameters(), 0, config.uav)
    pilot = Autopilot(airframe, vehicle_parameters(airframe, 1, 250, config.onboard()), config.onboard())
    setpoint = AttitudeSetpoint(LEVEL, (0.0, 0.0, 0.0), 0.9, 0)
    for step in range(1000):
        now = 0.004 * step
        step_alone(pilot, Measurement(now, LEVEL, (0.0, 0.0, 0.0), (0.0, 0.0, -5.0), (3.0, 0.0, 0.0)), now)
        if step == 0:
            pilot.enter_offboard(setpoint, now, now)
            pilot.arm(now, force=True)
        if pilot.state.hold is not None:
            return now, pilot.state.hold.plan
    raise AssertionError("the vehicle does not stop")


def test_vehicle_brakes_by_acceleration_of_motion_limits():
    durations = [stop_of(system(motion={"acceleration": a}))[1].duration for a in (1.5, 0.5)]
    assert durations == pytest.approx([4.0, 1.5 * 3.0 / (4.0 / 3.0 * 0.5)])


def test_vehicle_and_team_brake_in_the_time_of_guidance():
    config = system()
    guidance = replace(config.guidance, braking=replace(config.guidance.braking, time=6.0))
    config = replace(config, guidance=guidance)
    assert stop_of(config)[1].duration == 6.0
    assert config.braking().time == 6.0


@pytest.mark.parametrize("timeout", [0.46, 0.9])
def test_set_point_loss_of_vehicle_follows_telemetry_timeout_of_flight(timeout):
    config = system()
    config = replace(
        config, flight=replace(config.flight, failsafe=replace(config.flight.failsafe, telemetry_timeout=timeout))
    )
    assert stop_of(config)[0] == pytest.approx(timeout, abs=0.005)
    with Swarm(config, seed=1) as swarm:
        assert swarm.vehicles[0].parameters["COM_OF_LOSS_T"] == pytest.approx(timeout)


def test_partial_file_sets_descent_speed_of_vehicles(tmp_path):
    path = tmp_path / "system.toml"
    path.write_text("[autopilot.hold]\nland_speed = 0.3\n")
    config = read_system(path)
    assert stop_of(config)[1].descent_speed == pytest.approx(0.3)
    with Swarm(config, seed=1) as swarm:
        assert swarm.vehicles[3].parameters["MPC_LAND_SPEED"] == pytest.approx(0.3)


def test_vehicle_refuses_setpoint_beyond_its_rate_limit():
    config = read_system()
    limited = replace(config.autopilot, setpoints=SetpointSettings(rate_max=1.0))
    for settings, refused in ((config.autopilot, 0), (limited, 1)):
        bench = Bench(autopilot=settings)
        bench.send(attitude_target(rates=(0.0, 0.0, 1.5), mask=0))
        assert bench.vehicle.refused_setpoints == refused


def test_vehicle_streams_attitude_at_its_interval():
    link = read_system().vehicle_link
    counts = []
    for interval in (0.1, 0.5):
        bench = Bench(link=replace(link, intervals=StreamIntervals(attitude=interval)))
        bench.send(attitude_target())
        bench.run(2.0)
        counts.append(len(bench.got("ATTITUDE", GROUND)))
    assert counts == pytest.approx([20, 4], abs=1)


def test_vehicle_with_a_low_lift_threshold_is_in_the_air_earlier():
    heights = []
    for lifted in (0.15, 0.6):
        settings = read_system().autopilot
        bench = Bench(autopilot=replace(settings, land_detector=replace(settings.land_detector, lifted=lifted)))
        bench.streaming[GROUND, 255] = attitude_target(thrust=0.3)
        bench.run(0.2)
        assert bench.result(OFFBOARD) == bench.result(ARM) == ACCEPTED
        while not bench.vehicle.autopilot.state.land.in_air:
            bench.run(0.01)
        heights.append(-bench.body.position[2])
    assert heights[1] > heights[0] + 0.4


def test_payload_stands_on_pad_of_its_thickness():
    for thickness in (0.05, 0.2):
        settings = WorldConfig(pad=PadSettings(thickness=thickness))
        with World(read_system().parameters(), settings=settings) as world:
            state = run(world, 0.2, [0.0] * 4)
            assert state.payload_position_in_world[2] == pytest.approx(-0.25 - thickness, abs=1e-3)
            assert world.touching_ground()


@pytest.mark.parametrize(("factor", "held"), [(1.05, False), (1.5, True)])
def test_cradle_opens_at_its_release_factor(factor, held):
    config = read_system()
    settings = WorldConfig(cradles=CradleSettings(release_factor=factor))
    with World(config.parameters(), settings=settings) as world:
        state = run(world, 0.01, [1.2 * config.uav.mass * 9.81] * 4)
        assert uav_array(state, "cradled").tolist() == [held] * 4


def drag(world, force):
    """Pull the payload along the pad, below UAVs that carry little more than themselves."""
    for _ in range(100):
        world.step([8.0] * 4, STEADY, payload_force=(force, 0.0, 0.0))


@pytest.mark.parametrize(("friction", "slides"), [(0.8, False), (0.1, True)])
def test_payload_slides_on_the_pad_by_its_friction(friction, slides):
    settings = WorldConfig(bodies=BodySettings(friction=friction))
    with World(read_system().parameters(), settings=settings) as world:
        drag(world, 4.0)
        assert (world.state().payload_position_in_world[0] > 0.01) == slides


def test_links_have_their_radius():
    text = urdf_text(read_system().parameters(), link_radius=0.02)
    assert text.count('<cylinder radius="0.02"') == 2 * 4  # as they look and as they touch


@pytest.mark.parametrize(("speed", "at_rest"), [(0.1, False), (3.0, True)])
def test_what_moves_is_at_rest_below_the_speed_of_rest(speed, at_rest):
    config = replace(read_system(), world=WorldConfig(rest=RestSettings(speed=speed)))
    with Swarm(config, seed=1) as swarm:
        drag(swarm.world, 40.0)
        swarm.world.step([0.0] * 4, STEADY)
        assert 0.1 < np.linalg.norm(swarm.world.state().payload_velocity_in_world) < 3.0
        assert swarm.at_rest == at_rest


@pytest.mark.parametrize(("thrust", "at_rest"), [(0.1, False), (0.3, True)])
def test_rotors_have_run_down_at_the_thrust_of_rest(thrust, at_rest):
    config = replace(read_system(), world=WorldConfig(rest=RestSettings(thrust=thrust)))
    with Swarm(config, seed=1) as swarm:
        assert swarm.at_rest
        swarm.world.step([0.2] * 4, STEADY)
        assert swarm.at_rest == at_rest


@pytest.mark.parametrize(("rate", "rows"), [(50, 10), (100, 20)])
def test_truth_has_rows_at_its_rate(tmp_path, rate, rows):
    with Swarm(system(rates={"truth": rate}), seed=1) as swarm:
        swarm.record(TruthLog(tmp_path, 4))
        swarm.advance_to(0.2)
    header_and_start = 2
    assert len((tmp_path / "truth.csv").read_text().splitlines()) == header_and_start + rows


def test_wind_pushes_in_proportion_to_density_of_air():
    forces = []
    for density in (1.225, 2.45):
        config = replace(read_system(), world=WorldConfig(air=AirSettings(density=density)))
        wind = Fault(kind="wind", start=0.0, settings={"velocity": [3.0, 0.0, 0.0], "rise": 0.0})
        injector = FaultInjector([wind], 1, config)
        injector.took_off(0.0)
        with World(config.parameters()) as world:
            forces.append(np.array(injector.disturb(world, 1.0)[0]))
    np.testing.assert_allclose(forces[1], 2.0 * forces[0])
    assert forces[0][0] > 0.0
