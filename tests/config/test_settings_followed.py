"""Numbers that follow from a key of the system file: the key is changed and the behaviour follows."""

from contextlib import closing
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from braking_path import path_of
from standing_obstacles import StandingObstacles

from gcs.config import UnusableFile, read_system
from gcs.drivers.connection import Connection
from gcs.drivers.interrupt import Interrupt
from gcs.drivers.lockstep import run_in_lockstep
from gcs.flight import stack
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mavlink.requests import CommandState
from gcs.mavlink.vehicle_link import VehicleLink
from gcs.mission.read import read_mission
from idc_controller.estimation.health.channel_isolation import ChannelIsolation
from idc_controller.estimation.measurement_model import MeasurementModel
from idc_controller.estimation.measurements import Attitude, MeasurementNoise
from idc_controller.estimation.settings import MeasurementModelSettings
from idc_controller.geometry.shapes import Sphere
from idc_controller.model.linear import LinearModel
from idc_controller.safety.settings import PlannerSettings

NOTHING = StandingObstacles([])
STATE = np.array([[0.0, 0.0, -5.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])


def system(**tables):
    """The default system with keys of its tables changed."""
    config = read_system()
    return replace(config, **{name: replace(getattr(config, name), **keys) for name, keys in tables.items()})


def built(make, config, obstacles=NOTHING):
    return make(config, LinearModel(config.parameters()), obstacles)


@pytest.mark.parametrize("height", [0.5, 1.0])
def test_plan_keeps_payload_above_ground_whatever_its_height(height):
    config = system(payload={"size": (1.0, 1.0, height)})
    planner = built(stack.avoidance, config).planner
    chain = planner.settings.chain
    # Sinking towards a reference that is just above the ground.
    reference, start = np.zeros((5, chain.stages + 1, 3)), np.zeros((5, 3))
    reference[0, :, 2] = -height / 2.0 - 0.06
    start[:2, 2] = -1.5, 1.2
    free = planner.free(start)
    plan = planner.solve(start, reference, [], reference[2])
    underside = [(reference[0] + p.deviation[:, 0])[:, 2].max() + height / 2.0 for p in (free, plan)]
    assert underside[0] > 0.0
    assert underside[1] < 0.0


def test_detours_are_searched_above_ground_whatever_the_height_of_the_payload():
    lowest = [
        built(stack.guidance, system(payload={"size": (1.0, 1.0, height)})).navigator.lowest for height in (0.5, 1.0)
    ]
    assert lowest == pytest.approx([0.35, 0.6])


def test_lowest_waypoint_and_landing_follow_the_height_of_the_payload_and_of_the_pad(tmp_path):
    (tmp_path / "system.toml").write_text("[payload]\nsize = [1.0, 1.0, 1.0]\n[world.pad]\nthickness = 0.2\n")
    path = tmp_path / "hop.toml"
    points = '[mission]\nname = "hop"\n[reference]\nkind = "waypoints"\npoints = [[5.0, 0.0, {z}]]\n'
    path.write_text(points.format(z=-0.75))
    *_, landing = read_mission(path).reference.legs()
    assert landing.position[2] == pytest.approx(-0.7)
    path.write_text(points.format(z=-0.65))
    with pytest.raises(UnusableFile, match=r"hop.toml: line 5: reference.points.*limit -0.7 m"):
        read_mission(path)
    figure = '[mission]\nname = "figure"\n[reference]\nkind = "lissajous"\namplitude = [6.0, 3.0]\n'
    path.write_text(figure + "angular_frequency = 0.5\naltitude = 0.65\nduration = 30.0\n")
    with pytest.raises(UnusableFile, match=r"hop.toml: line 7: reference.altitude: 0.65 m .*limit 0.7 m"):
        read_mission(path)


def test_stop_without_setpoints_keeps_farther_off_with_a_larger_margin():
    place = np.array([4.0, 2.4, -5.0])
    obstacles = StandingObstacles([("beside", Sphere(0.5), place)])
    distances = []
    for margin in (0.5, 1.2):
        choice = built(stack.resting_place, system(avoidance={"margin": margin}), obstacles)(0.0, STATE)
        rest = path_of(choice, STATE)(choice.duration(STATE[1]))
        distances.append(np.linalg.norm(rest - place))
    assert distances[1] > distances[0] + 0.3


@pytest.mark.parametrize(("spacing", "limit"), [(1.0, 0.77), (1.4, 0.94)])
def test_separation_limit_follows_spacing_of_the_team(spacing, limit):
    config = system(team={"spacing": spacing})
    model = LinearModel(config.parameters())
    tracker = stack.controller(config, model, None, lambda: 0.0).tracker
    separation = tracker.by_age[0].state_constraints[-1]
    assert separation.distance == pytest.approx(limit)
    assert separation.limits == pytest.approx(np.full(4, spacing - limit))


def test_limits_of_plans_follow_limits_of_motion():
    planner = built(stack.avoidance, system(motion={"acceleration": 0.6, "snap": 3.0})).planner
    chain = planner.settings.chain
    reference, start = np.zeros((5, chain.stages + 1, 3)), np.zeros((5, 3))
    reference[0, :, 2], start[0] = -5.0, [3.0, 0.0, 0.0]
    plan = planner.solve(start, reference, [], np.zeros((chain.stages + 1, 3)))
    limited = np.arange(3, chain.stages + 1, 3)
    assert np.abs(plan.deviation[limited, 2, 0]).max() <= 1.2 + 1e-6
    assert np.abs(plan.deviation[1:, 4, 0]).max() <= 3.0 + 1e-6
    assert np.abs(PlannerSettings().acceleration_limit).max() == 3.0


def test_stop_without_setpoints_takes_longer_with_a_smaller_acceleration():
    durations = [
        built(stack.resting_place, system(motion={"acceleration": a}))(0.0, STATE).duration(np.array([3.0, 0.0, 0.0]))
        for a in (1.5, 0.5)
    ]
    assert durations == pytest.approx([4.0, 1.5 * 3.0 / (4.0 / 3.0 * 0.5)])


def test_isolation_of_a_channel_takes_as_long_at_any_rate_of_telemetry():
    times = []
    for telemetry in (25, 50):
        config = system(rates={"telemetry": telemetry})
        settings = config.estimation.estimator.at_rates(telemetry, config.rates.control).isolation
        isolation = ChannelIsolation(4, settings)
        model = MeasurementModel(LinearModel(config.parameters()), MeasurementNoise(), MeasurementModelSettings())
        stack_of_one = model.observation(((0, Attitude),)).stack
        tested, accepted = np.ones(4, dtype=bool), np.zeros(4, dtype=bool)
        steps = 0
        while not isolation.isolated:
            isolation.learn(stack_of_one, tested, accepted, lambda uav: True)
            steps += 1
        times.append(steps / telemetry)
    assert times == [0.48, 0.48]


@pytest.mark.parametrize("tries", [2, 4])
def test_commands_are_repeated_as_often_and_as_soon_as_the_file_says(tmp_path, tries):
    path = tmp_path / "system.toml"
    path.write_text(f"[mavlink.link]\ntries = {tries}\nretry_interval = 0.2\n")
    requests = VehicleLink(1, None, read_system(path).mavlink.link).requests
    command = requests.command(400, 1.0)
    sent = [0.05 * k for k in range(40) if requests.due(0.05 * k)]
    assert sent == pytest.approx([0.2 * k for k in range(tries)])
    assert command.state is CommandState.UNANSWERED


def test_world_without_ticks_is_lost_after_the_time_of_the_file(tmp_path):
    path = tmp_path / "system.toml"
    path.write_text("[drivers]\njoin_interval = 0.02\ntick_timeout = 0.05\n")
    reasons = []
    station = SimpleNamespace(
        ended=False, resume=lambda: None, raise_failsafe=lambda now, failsafe, reason: reasons.append(reason)
    )
    with closing(Connection()) as ground, closing(Connection()) as world:
        run_in_lockstep(station, ground, world.socket.getsockname(), Interrupt(), read_system(path).drivers)
    assert reasons == ["the simulated world does not answer for 0.05 s"]


def test_waypoints_are_passed_within_the_corner_of_the_motion(tmp_path):
    path = tmp_path / "corner.toml"
    path.write_text(
        '[mission]\nname = "corner"\nseed = 1\n[reference]\nkind = "waypoints"\nspeed = 1.5\n'
        "points = [[6.0, 0.0, -3.0], [6.0, 6.0, -3.0], [0.0, 6.0, -3.0]]\n"
    )
    mission, distances = read_mission(path), []
    for corner in (0.2, 0.05):
        flown = MissionTrajectory(
            replace(mission, system=system(motion={"corner": corner})), np.zeros(3), 0.0
        ).trajectory
        positions = flown.derivatives(np.arange(0.0, 40.0, 0.01), 0)[0]
        distances.append(np.linalg.norm(positions - [6.0, 6.0, -3.0], axis=1).min())
    assert distances[1] <= 0.051 < distances[0] <= 0.201
