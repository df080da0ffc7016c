"""What the engine lacks of products of velocities, against central differences of motions at constant joint rates."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vehicle_sim.world.state_kernels import LOAD_COLUMNS, PART_COLUMNS, STATE_COLUMNS, states_from_engine

STEP = 0.002
RNG = np.random.default_rng(11)
VEHICLES = 4
WORLD_AXES = [0.0, 0.0, 0.0, 1.0]


def products(rates, arm, link, link_rates, uav_rates, dt=1e-4):
    """Acceleration and angular acceleration of a UAV while payload and joints keep their rates."""

    def motion(t):
        payload = Rotation.from_rotvec(rates * t)
        of_link = payload * Rotation.from_rotvec((link_rates - rates) * t)
        uav = of_link * Rotation.from_rotvec((uav_rates - link_rates) * t)
        turning = rates + of_link.apply(link_rates - rates) + uav.apply(uav_rates - link_rates)
        return payload.apply(arm) + of_link.apply(link), turning

    (before, turned), (now, _), (after, turning) = motion(-dt), motion(0.0), motion(dt)
    return (before - 2.0 * now + after) / dt**2, (turning - turned) / (2.0 * dt)


def link_rates_of(velocity, rates, uav_velocity, arm, link, since):
    """The link's rates from velocities that are older than its direction by ``since``; then none is about it."""
    across = np.cross(link, uav_velocity - velocity - np.cross(rates, arm)) / (link @ link)
    return across + since * (np.cross(rates, across) @ link) / (link @ link) * link


def gyroscopic(inertia, rates):
    return np.cross(rates, inertia @ rates)


def scene():
    """Rows of readings with links that keep their lengths, and of parts; all frames those of the world."""
    n = VEHICLES
    arms, links = RNG.normal(size=(n, 3)), 3.0 + RNG.random(n)
    directions = RNG.normal(size=(n, 3))
    links = links[:, None] * directions / np.linalg.norm(directions, axis=1, keepdims=True)
    place, attitudes = RNG.normal(size=3), Rotation.random(n + 1, random_state=5)
    attitudes = Rotation.from_quat([WORLD_AXES, *attitudes.as_quat()[1:]])
    v, w = RNG.normal(size=3), RNG.normal(size=3)
    uavs = v + np.cross(w, arms) + np.cross(RNG.normal(size=(n, 3)), links)
    now = np.column_stack([np.vstack([v, uavs]), np.vstack([w, RNG.normal(size=(n, 3))])])
    places = np.vstack([place, place + arms + links])
    parts = np.column_stack([0.1 + RNG.random((n + 1, 3)), 1.0 + RNG.random(n + 1), np.vstack([place, arms])])
    poses = np.column_stack([places, attitudes.as_quat()])
    before = np.hstack([poses, now + 0.1 * RNG.normal(size=now.shape)])
    return np.hstack([poses, now]), before, parts, arms, links


def test_loads_and_velocities_are_those_of_differences():
    readings, before, parts, arms, links = scene()
    states, loads = np.empty((VEHICLES + 1, STATE_COLUMNS)), np.empty((VEHICLES + 1, LOAD_COLUMNS))
    assert parts.shape[1] == PART_COLUMNS
    states_from_engine(readings, before, parts, np.array(WORLD_AXES), STEP, states, loads)
    assert np.abs(loads[0, 3:]).max() > 1e-3 and np.abs(loads[1:]).max(axis=0).min() > 1e-3
    v, w = readings[0, 7:10], readings[0, 10:13]
    v_new, w_new = 1.5 * v - 0.5 * before[0, 7:10], 1.5 * w - 0.5 * before[0, 10:13]
    flip = np.diag([1.0, -1.0, -1.0])
    assert states[0, 7:10] == pytest.approx(flip @ v_new)
    assert states[0, 10:] == pytest.approx(flip @ w_new)
    inertia = np.diag(parts[0, :3])
    assert loads[0, :3].tolist() == [0.0] * 3
    assert loads[0, 3:] == pytest.approx(gyroscopic(inertia, w) - gyroscopic(inertia, w_new))
    for row, earlier, part, state, load, arm, link in zip(
        readings[1:], before[1:], parts[1:], states[1:], loads[1:], arms, links, strict=True
    ):
        v_i, w_i = row[7:10], row[10:13]
        old = products(w, arm, link, link_rates_of(v, w, v_i, arm, link, STEP / 2), w_i)
        v_on = 1.5 * v_i - 0.5 * earlier[7:10] - STEP / 2 * old[0]
        w_on = 1.5 * w_i - 0.5 * earlier[10:13] - STEP / 2 * old[1]
        new = products(w_new, arm, link, link_rates_of(v_new, w_new, v_on, arm, link, 0.0), w_on)
        R, inertia = Rotation.from_quat(row[3:7]).as_matrix(), np.diag(part[:3])
        assert state[7:10] == pytest.approx(flip @ v_on, abs=1e-8)
        assert state[10:] == pytest.approx(flip @ R.T @ w_on, abs=1e-8)
        assert load[:3] == pytest.approx(part[3] * R.T @ (old[0] - new[0]), abs=1e-5)
        torque = inertia @ R.T @ (old[1] - new[1]) + gyroscopic(inertia, R.T @ w_i) - gyroscopic(inertia, R.T @ w_on)
        assert load[3:] == pytest.approx(torque, abs=1e-5)


def test_without_a_step_before_nothing_is_missing():
    readings, _, parts, *_ = scene()
    states, loads = np.empty((VEHICLES + 1, STATE_COLUMNS)), np.empty((VEHICLES + 1, LOAD_COLUMNS))
    states_from_engine(readings, readings, parts, np.array(WORLD_AXES), 0.0, states, loads)
    assert loads == pytest.approx(0.0, abs=1e-12)
    assert states[:, 7:10] == pytest.approx(readings[:, 7:10] * [1.0, -1.0, -1.0])
