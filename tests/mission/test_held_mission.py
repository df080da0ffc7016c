"""A mission that is held on its way, and gone on with where it was left: its legs, and the trajectory."""

from itertools import chain, groupby

import numpy as np
import pytest
from flights import short_figure
from mission_files import RETURN, TAKE_OFF, A, B, read, row, wpl

from gcs.flight.mission_legs import MissionLegs
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.mission.read import read_mission

STEP, LONGEST = 0.02, 400.0
TURNS = row(18, 2.3, 0, 6.0, north=20.0)
MISSIONS = {
    "waypoints and a jump": wpl(TAKE_OFF, A, B, row(177, 2, 1), RETURN),
    "hold": wpl(TAKE_OFF, row(16, 6.0, north=10.0), B, RETURN),
    "circle": wpl(TAKE_OFF, TURNS, RETURN),
    "speed": wpl(TAKE_OFF, A, row(178, 1, 0.7), B, RETURN),
}


class Flown:
    """A mission that is flown, held at ``held`` (s) for ``pause`` (s), and gone on with; inf: never held."""

    def __init__(self, mission, held=np.inf, pause=8.0):
        legs = MissionLegs.of(mission)
        whole = MissionTrajectory(mission, np.array([0.0, 0.0, -0.25]), 0.0, legs.flight())
        passed, parts = [], []
        if held < np.inf:
            before = whole.trajectory
            parts.append(np.arange(0.0, held, STEP))
            parts[0] = before.derivatives(parts[0])
            at = before.derivatives([held])
            whole.hold(before, held, held)
            self.jump = np.abs(whole.trajectory.derivatives([held]) - at).max(axis=(1, 2))
            on = held + pause
            parts.append(whole.trajectory.derivatives(np.arange(held, on, STEP)))
            self.rests = not parts[-1][1:, -1].any() and whole.is_held and whole.phase(on) == "hold"
            passed = whole.passed(on)
            rest = MissionLegs(chain(whole.remaining(), legs))
            whole.go_on(whole.trajectory, on, rest.flight(), 1.5)
            assert not whole.is_held
        else:
            on = 0.0
        whole.trajectory.derivatives([LONGEST], 0)
        parts.append(whole.trajectory.derivatives(np.arange(on, whole.landing_from, STEP)))
        self.derivatives = np.concatenate(parts, axis=1)
        self.duration = whole.landing_from
        self.passed = [source for source, _ in groupby([*passed, *whole.passed(LONGEST)])]
        self.curve = getattr(whole._legs, "_curve", None)


@pytest.mark.parametrize("share", [0.05, 0.25, 0.4, 0.5, 0.6, 0.75, 0.99])
@pytest.mark.parametrize("name", MISSIONS)
def test_held_mission_goes_on_where_it_was_left(tmp_path, name, share):
    mission = read(tmp_path, MISSIONS[name])
    undisturbed = Flown(mission)
    held = Flown(mission, share * undisturbed.duration)
    assert held.passed == undisturbed.passed
    path, other = held.derivatives[0], undisturbed.derivatives[0]
    assert path[-1] == pytest.approx(other[-1], abs=1e-3)
    away = np.linalg.norm(path[:, None, ::1] - other[None, ::5], axis=2).min(axis=1)
    assert away.max() < mission.system.motion.corner + 0.05, "it stays on the path"
    missed = np.linalg.norm(other[::25, None] - path[None, ::2], axis=2).min(axis=1)
    assert missed.max() < mission.system.motion.corner + 0.05, "it flies all of the path"
    assert held.duration < undisturbed.duration + 8.0 + 6.0


@pytest.mark.parametrize("share", [0.05, 0.3, 0.55, 0.8])
def test_hold_is_reached_within_the_limits_without_a_step_and_left_as_well(tmp_path, share):
    mission = read(tmp_path, MISSIONS["circle"])
    held = Flown(mission, share * Flown(mission).duration)
    assert held.rests and held.jump.max() < 1e-6
    norms = np.linalg.norm(held.derivatives, axis=2).max(axis=1)
    limits = mission.system.motion
    assert norms[1] < limits.speed + 1e-3 and norms[2] < limits.limits.acceleration + 1e-3
    assert norms[3] < limits.limits.jerk + 1e-3 and norms[4] < limits.limits.snap + 1e-3
    assert np.abs(np.diff(held.derivatives[2], axis=0)).max() < limits.limits.jerk * STEP + 1e-3


@pytest.mark.parametrize("rate", [0.9, 0.7, 0.1])
def test_waypoint_passed_before_a_slow_progress_comes_to_rest_is_not_flown_to_again(tmp_path, rate):
    mission = read(tmp_path, wpl(TAKE_OFF, A, B, RETURN))
    whole = MissionTrajectory(mission, np.array([0.0, 0.0, -0.25]), 0.0)
    times = np.arange(0.0, 60.0, STEP)
    before = times[np.searchsorted(whole.trajectory.derivatives(times, 0)[0, :, 0], 9.9)]
    whole.hold(whole.trajectory.scaled(before, rate, 100.0), 100.0, before)
    rest = whole.trajectory.position(120.0)[0]
    assert rest > 10.0 and whole.remaining()[0].position[0] == pytest.approx(20.0, abs=1e-2)


@pytest.mark.parametrize("share", [0.02, 0.1, 0.3, 0.45, 0.6, 0.75, 0.9])
def test_curve_goes_on_at_its_own_point_for_the_rest_of_its_duration(tmp_path, share):
    mission = read_mission(short_figure(tmp_path))
    undisturbed = Flown(mission)
    held = Flown(mission, share * undisturbed.duration)
    assert held.passed == undisturbed.passed
    path = held.derivatives[0]
    assert path[-1] == pytest.approx(undisturbed.derivatives[0][-1], abs=1e-3)
    step = np.linalg.norm(np.diff(path, axis=0), axis=1)
    assert step.max() < mission.system.motion.curve_speed * STEP + 1e-6
    a, b = mission.reference.amplitude
    phases = np.linspace(0.0, 2.0 * np.pi, 2000)
    curve = np.stack([a * np.sin(phases), -b * np.sin(2.0 * phases)], axis=1)
    along = undisturbed.derivatives[0][: round(undisturbed.curve.full_rate[1] / STEP) : 25]
    missed = np.linalg.norm(along[:, None] - path[None, ::2], axis=2).min(axis=1)
    assert missed.max() < 2 * mission.system.motion.curve_speed * STEP, "it flies all of the curve"
    back = 0 if held.curve is None else round((held.duration - held.curve.end) / STEP)
    curved = path[: len(path) - back : 3]
    high = curved[curved[:, 2] < -mission.reference.altitude + 1e-3]
    beside = np.linalg.norm(high[:, None, :2] - curve[None], axis=2).min(axis=1)
    assert held.curve is None or beside.max() < 0.02, "it stays on the curve"
