"""True velocities and missing loads, against a chain of bodies that is moved as the engine moves it."""

from dataclasses import dataclass

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from vehicle_sim.world.state_kernels import (
    AXIS,
    LOAD_COLUMNS,
    MEMORY_COLUMNS,
    PART_COLUMNS,
    STATE_COLUMNS,
    states_from_engine,
)

STEP = 0.002
VEHICLES = 4
FLIP = np.diag([1.0, -1.0, -1.0])
IN_AXES = Rotation.random(random_state=9)  # payload frame to principal axes


def gyroscopic(moments, rates):
    return np.cross(rates, moments * rates)


@dataclass
class Chain:
    """Payload, a link along its own z axis, a UAV; in the engine's world."""

    place: np.ndarray
    payload: Rotation
    link: Rotation
    uav: Rotation
    arm: np.ndarray
    length: float

    def moved(self, rates, t):
        """After ``t`` seconds with constant rates: payload's velocity, its rates, the joints' in the child's frame."""
        v, w, a, b = rates
        turn = Rotation.from_rotvec(w * t)
        link = turn * self.link * Rotation.from_rotvec(a * t)
        relative = self.link.inv() * self.uav
        uav = link * relative * Rotation.from_rotvec(b * t)
        return Chain(self.place + v * t, turn * self.payload, link, uav, self.arm, self.length)

    @property
    def axis(self):
        return self.link.as_matrix()[:, 2]

    def uav_place(self):
        return self.place + self.payload.apply(self.arm) + self.length * self.axis

    def turning(self, rates):
        """Angular velocities of payload, link and UAV."""
        _, w, a, b = rates
        of_link = w + self.link.apply(a)
        return w, of_link, of_link + self.uav.apply(b)

    def motion(self, rates):
        """Velocity and angular velocity of the UAV."""
        w, of_link, of_uav = self.turning(rates)
        velocity = rates[0] + np.cross(w, self.payload.apply(self.arm)) + np.cross(of_link, self.length * self.axis)
        return velocity, of_uav

    def products(self, rates, dt=1e-4):
        """Acceleration and angular acceleration of the UAV at constant rates, by differences."""
        before, after = self.moved(rates, -dt), self.moved(rates, dt)
        return tuple((b - a) / (2.0 * dt) for a, b in zip(before.motion(rates), after.motion(rates), strict=True))

    def without_torque_about_the_axis(self, rates, before):
        """``rates`` that follow ``before``, where nothing but the engine's products acts about the link's axis."""
        v, w, a, b = rates
        w_before, of_link, _ = self.turning(before)
        wanted = self.axis @ of_link - STEP * self.axis @ np.cross(w_before, of_link)
        return v, w, np.add(a, [0.0, 0.0, wanted - self.axis @ (w + self.link.apply(a))]), b


def chains(rng):
    """A chain for each vehicle, the payload the same."""
    payload, place = Rotation.random(random_state=2), rng.normal(size=3)
    for k in range(VEHICLES):
        link, uav = Rotation.random(2, random_state=20 + k)
        yield Chain(place, payload, link, uav, rng.normal(size=3), 3.0 + rng.random())


def reading(chain, rates):
    """Rows of payload and UAV as the engine gives them."""
    v, w = chain.motion(rates)
    return (
        [*chain.place, *chain.payload.as_quat(), *rates[0], *rates[1]],
        [*chain.uav_place(), *chain.uav.as_quat(), *v, *w],
    )


@pytest.mark.parametrize("weights", [(), (0.5,), (0.875, -0.375)], ids=["no step", "one step", "two steps"])
def test_loads_and_velocities_are_those_of_rates_brought_forward(weights):
    rng = np.random.default_rng(11)
    all_chains, rows = list(chains(rng)), VEHICLES + 1
    parts = np.column_stack([0.1 + rng.random((rows, 3)), 1.0 + rng.random((rows, 4))])
    memory, states, loads = (np.zeros((rows, n)) for n in (MEMORY_COLUMNS, STATE_COLUMNS, LOAD_COLUMNS))
    assert parts.shape[1] == PART_COLUMNS
    all_rates = rng.normal(size=(1 + VEHICLES, 2, 3))
    history = [[] for _ in all_chains]
    for steps in range(len(weights) + 1):
        readings = np.empty((rows, 13))
        for i, chain in enumerate(all_chains, start=1):
            rates = *all_rates[0], *all_rates[i]
            if steps == 0:
                parts[i, 4:] = chain.arm
                memory[i, AXIS:] = *chain.axis, chain.axis @ chain.turning(rates)[1]
            else:
                rates = chain.without_torque_about_the_axis(rates, history[i - 1][0])
                all_chains[i - 1] = chain = chain.moved(rates, STEP)
            history[i - 1].insert(0, np.array(rates))
            readings[0], readings[i] = reading(chain, rates)
        states_from_engine(readings, parts, IN_AXES.as_quat(), STEP, steps, memory, states, loads)
        all_rates = all_rates + 0.1 * rng.normal(size=all_rates.shape)
    for i, (chain, rates) in enumerate(zip(all_chains, history, strict=True), start=1):
        old, new = rates[0], rates[0].copy()
        for k, weight in enumerate(weights):
            new += weight * (rates[k] - rates[k + 1])
        assert states[0, 7:10] == pytest.approx(FLIP @ new[0])
        assert states[0, 10:] == pytest.approx(FLIP @ (chain.payload * IN_AXES).inv().apply(new[1]))
        w, w_new = chain.payload.inv().apply([old[1], new[1]])
        assert loads[0, :3].tolist() == [0.0] * 3
        assert loads[0, 3:] == pytest.approx(gyroscopic(parts[0, :3], w) - gyroscopic(parts[0, :3], w_new))
        (v_new, w_new), w = chain.motion(new), chain.motion(old)[1]
        linear, angular = np.subtract(chain.products(old), chain.products(new))
        into_body, moments = chain.uav.inv().apply, parts[i, :3]
        assert states[i, 7:10] == pytest.approx(FLIP @ v_new, abs=1e-7)
        assert states[i, 10:] == pytest.approx(FLIP @ into_body(w_new), abs=1e-7)
        torque = gyroscopic(moments, into_body(w)) - gyroscopic(moments, into_body(w_new))
        assert loads[i, :3] == pytest.approx(parts[i, 3] * into_body(linear), abs=1e-6)
        assert loads[i, 3:] == pytest.approx(moments * into_body(angular) + torque, abs=1e-6)
        # What is missing is far larger than the tolerances, or nothing.
        assert np.abs(loads[i]).min() > 1e-3 if weights else not loads.any()
