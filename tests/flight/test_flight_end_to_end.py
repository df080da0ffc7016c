"""Missions from end to end: estimator, controller, MAVLink bytes, onboard loops and PyBullet world, in lockstep."""

import numpy as np
import pytest
from flights import MISSIONS, check_within_limits, flown, short_figure, truth_of
from programs import gcs_fly

from gcs.mission.read import read_mission
from gcs.mission.route import FlyTo

pytestmark = pytest.mark.slow


def test_figure_eight_is_flown_within_limits(tmp_path):
    """By the command, with a seed that nobody tuned for."""
    code, summary = gcs_fly(short_figure(tmp_path, duration=8.0), tmp_path / "run", "--seed", 7341)
    assert code == 0
    assert summary["outcome"] == "completed"
    check_within_limits(summary)
    assert (tmp_path / "run" / "report.html").exists() and (tmp_path / "run" / "poster.png").exists()


@pytest.mark.parametrize(
    "vehicles", [3, pytest.param(8, marks=pytest.mark.long)]
)  # the fewest, an odd number; and many
def test_figure_eight_is_flown_by_other_team_sizes(tmp_path, vehicles):
    mission = read_mission(short_figure(tmp_path, duration=4.0, altitude=1.5, vehicles=vehicles))
    summary = flown(mission, tmp_path / "run", seed=11)
    check_within_limits(summary)


# Waypoints


@pytest.mark.parametrize("name", ["delivery.plan", pytest.param("square.waypoints", marks=pytest.mark.long)])
def test_every_waypoint_is_passed_and_every_hold_held(tmp_path, name):
    mission = read_mission(MISSIONS / name)
    summary = flown(mission, tmp_path / "run", seed=17)
    assert summary["completed"], summary
    assert summary["contacts"] == 0
    assert max(summary["payload_tilt_max_deg"].values()) <= 5.0
    assert summary["uav_separation_min_m"] >= 0.7

    truth = truth_of(tmp_path / "run")
    time = truth["time_s"]
    position = np.column_stack([truth[f"payload_{axis}_m"] for axis in "xyz"])
    waypoints = [leg for leg in mission.reference.legs() if isinstance(leg, FlyTo)]
    assert len(waypoints) >= 3
    begin = 0
    for leg in waypoints:  # in their order
        distance = np.linalg.norm(position[begin:] - leg.position, axis=1)
        near = np.flatnonzero(distance < 0.3)
        assert len(near), f"{leg.position} is missed by {distance.min():.2f} m"
        if leg.hold > 0.0:
            close = distance < 0.1
            # The longest time without leaving the place.
            edges = np.flatnonzero(np.diff(np.concatenate([[False], close, [False]]).astype(int)))
            stays = [time[begin + b - 1] - time[begin + a] for a, b in edges.reshape(-1, 2)]
            assert stays, leg.position
            assert max(stays) >= leg.hold - 0.1, f"{leg.position}: held {max(stays):.1f} s of {leg.hold} s"
        begin += near[0]
