"""A single UAV as a free rigid body, for tests of the onboard side: no payload, no world engine."""

from __future__ import annotations

import math

import numpy as np

from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.world.rotors import RotorGeometry, Rotors
from vehicle_sim.world.sensors import Measurement, NavigationSensors, SensorNoise

AIRFRAME = Airframe(
    mass=0.7,
    inertia=((0.01, 0.0, 0.0), (0.0, 0.01, 0.0), (0.0, 0.0, 0.01)),
    rotors=RotorGeometry(30.0, 1000.0, 0.17, 0.016),
    motor_time_constant=0.05,
    attitude_kp=100.0,
    attitude_kd=16.0,
)
GRAVITY = np.array([0.0, 0.0, AIRFRAME.g])
PHYSICS_STEP = 0.002
ONBOARD_EVERY = 2


def measured(sensor: NavigationSensors, now: float, attitude, rates, position, velocity) -> Measurement:
    """One sample of the sensor of one vehicle."""
    state = np.concatenate([position, attitude, velocity, rates])
    return Measurement.of_row(now, sensor.measure(state[None])[0].tolist())


class Body:
    """Mass ``carried`` hangs at the centre, so that the vehicle has to learn what it carries. Ground at z = 0."""

    def __init__(self, carried: float = 0.0, noise: SensorNoise | None = None, seed: int = 0) -> None:
        self.mass = AIRFRAME.mass + carried
        self.sensor = NavigationSensors([noise or SensorNoise()], seed, [1])
        self.rotors = Rotors([AIRFRAME.rotors], [AIRFRAME.motor_time_constant], PHYSICS_STEP)
        self.command = (0.0, 0.0, 0.0, 0.0)
        self.thrust = 0.0
        self.tick = 0
        self.position = np.zeros(3)
        self.velocity = np.zeros(3)
        self.attitude = np.array([1.0, 0.0, 0.0, 0.0])
        self.rates = np.zeros(3)

    @property
    def now(self) -> float:
        return self.tick * PHYSICS_STEP

    def measure(self) -> Measurement:
        return measured(self.sensor, self.now, self.attitude, self.rates, self.position, self.velocity)

    def advance(self) -> None:
        [[self.thrust]], [[torque]] = self.rotors.advance(np.array([self.command]))
        w, x, y, z = self.attitude.tolist()
        # The third column of the rotation matrix; the inertia is a multiple of the identity: no gyroscopic term.
        up = np.array([2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)])
        self.velocity = self.velocity + PHYSICS_STEP * (GRAVITY - up * (self.thrust / self.mass))
        self.rates = self.rates + PHYSICS_STEP / AIRFRAME.inertia[0][0] * np.array(torque)
        self.position = self.position + self.velocity * PHYSICS_STEP
        p, q, r = (0.5 * PHYSICS_STEP * self.rates).tolist()
        half = math.sqrt(p * p + q * q + r * r)
        scale = math.sin(half) / half if half > 1e-12 else 1.0
        c, a, b, d = math.cos(half), scale * p, scale * q, scale * r
        turned = (
            w * c - x * a - y * b - z * d,
            x * c + w * a + y * d - z * b,
            y * c + w * b + z * a - x * d,
            z * c + w * d + x * b - y * a,
        )
        self.attitude = np.array(turned) / math.sqrt(sum(component * component for component in turned))
        if self.position[2] > 0.0:  # the ground: no bounce, no sliding, no tipping
            self.position[2] = 0.0
            if self.velocity[2] > 0.0:
                self.velocity = np.zeros(3)
                self.rates = np.zeros(3)
        self.tick += 1
