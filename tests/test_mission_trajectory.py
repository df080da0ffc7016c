"""Mission trajectory: the payload's way from pad to ground."""

import numpy as np
import pytest
from flight_in_process import short_figure
from mission_files import RETURN, TAKE_OFF, A, read, row, wpl

from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.read import read_mission


def test_figure_begins_with_a_climb_at_once(tmp_path):
    flown = MissionTrajectory(read_mission(short_figure(tmp_path)), np.array([1.0, 2.0, 0.0]), start=3.0)
    position = flown.trajectory.derivatives(np.array([3.0, 3.9]), 0)[0]
    np.testing.assert_allclose(position[0], [1.0, 2.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(position[1, :2], [1.0, 2.0], atol=1e-12)
    assert position[1, 2] < -0.005
    assert flown.phase(3.0) == "climb"


@pytest.mark.parametrize("delay", [0.0, 4.0])
def test_delay_before_take_off_is_spent_on_the_pad(tmp_path, delay):
    items = [row(93, delay)] if delay else []
    flown = MissionTrajectory(read(tmp_path, wpl(*items, TAKE_OFF, A, RETURN)), np.zeros(3), start=3.0)
    height = -flown.trajectory.derivatives(3.0 + delay + np.array([-0.1, 0.0, 4.0]), 0)[0][:, 2]
    assert height[:2] == pytest.approx(0.0, abs=1e-3) and height[2] > 0.05


def test_figure_ends_where_the_climb_ended_and_descends_there(tmp_path):
    mission = read_mission(short_figure(tmp_path))
    flown = MissionTrajectory(mission, np.array([1.0, 2.0, 0.0]), start=3.0)
    trajectory = flown.trajectory
    trajectory.derivatives(np.array([200.0]), 0)
    times = np.linspace(3.0, trajectory.end, 4000)
    path, velocity = trajectory.derivatives(times, 1)
    np.testing.assert_allclose(path[-1, :2], [1.0, 2.0], atol=0.01)
    figure = path[path[:, 2] < -mission.reference.altitude + 0.01]
    assert np.ptp(figure[:, 0]) > mission.reference.amplitude[0]
    assert np.linalg.norm(velocity, axis=1).max() <= mission.system.motion.curve_speed
