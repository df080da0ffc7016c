"""The load that the reference is made for: payload mass, disturbance forces and wind, learnt from the estimates."""

import math

import numpy as np

from idc_controller.arrays import Array
from idc_controller.control.force_kernels import followed
from idc_controller.control.settings import ControllerSettings
from idc_controller.estimation.health.attitude_steps import AttitudeStep
from idc_controller.estimation.measurements import Estimate
from idc_controller.estimation.wind import WindEstimator
from idc_controller.model.drag import Air
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import Load


class LoadAdaptation:
    """Follows the estimator's forces and mass excess, more slowly than the estimate itself and within limits."""

    def __init__(self, model: LinearModel, settings: ControllerSettings) -> None:
        self.parameters, self.layout, self.settings = model.parameters, model.layout, settings
        self._weight = self.parameters.m_0 * self.parameters.g
        self._uav_limit = settings.force_limit * float(self.parameters.hover_thrust.min())
        self.estimate = Load(self.parameters.m_0, np.zeros(3), np.zeros((self.parameters.number_of_uavs, 3)))
        self.wind = WindEstimator(
            self.parameters.payload.areas, settings.period, settings.drag_limit * self._weight, settings.wind
        )

    @property
    def payload_mass(self) -> float:
        """Mass (kg) whose weight the links carry at rest in still air, as it is learnt.

        The estimated mass with the vertical disturbance force, from which it cannot be told at rest, without the drag
        that the wind explains. While the ground may carry part of the payload it stays as it was.
        """
        load = self.estimate
        return load.mass + float(load.force[2]) / self.parameters.g

    @property
    def on_uavs(self) -> Array:
        """Forces on the UAVs (N, 3) (N) at rest, as they are learnt."""
        return self.estimate.uav_force + _drag(self.estimate.air, np.zeros(3))[1]

    def take_mass(self, mass: float) -> None:
        """Take a ``mass`` (kg) of the payload at once, within its limits; the level forces stay."""
        least, most = self.settings.mass_share
        mass = min(max(mass, least * self.parameters.m_0), most * self.parameters.m_0)
        load = self.estimate
        self.estimate = Load(mass, load.force * np.array([1.0, 1.0, 0.0]), load.uav_force, load.air)

    def take_attitude_step(self, step: AttitudeStep) -> None:
        """Take the force of a UAV whose thrust is off its attitude by a ``step``, at once."""
        load, i = self.estimate, step.uav
        uav_force = load.uav_force.copy()
        uav_force[i, :2] -= self.parameters.hover_thrust[i] * step.angle
        uav_force[i] *= self._uav_limit / max(float(np.linalg.norm(uav_force[i])), self._uav_limit)
        self.estimate = Load(load.mass, load.force, uav_force, load.air)

    def start(self) -> None:
        """Lean against the wind of the flight before: at lift-off nothing else holds the payload any more."""
        air, load = self.wind.air, self.estimate
        _, uav_drag = _drag(air, np.zeros(3))
        self.estimate = Load(load.mass, load.force * np.array([0.0, 0.0, 1.0]), load.uav_force - uav_drag, air)

    def release(self) -> None:
        """Let links that lean against the wind come upright: the ground holds the payload, whose weight stays."""
        share = self.settings.period / self.settings.upright_time_constant
        load = self.estimate
        force = load.force + _drag(load.air, np.zeros(3))[0]
        force[:2] *= 1.0 - share
        self.estimate = Load(load.mass, force, self.on_uavs)

    def learn(self, estimate: Estimate) -> None:
        """Follow the disturbance forces and the mass excess of ``estimate``."""
        load = self.estimate
        share = self.settings.period / self.settings.load_time_constant
        least, most = self.settings.mass_share
        mass = load.mass + share * (self.parameters.m_0 + estimate.mass_excess - load.mass)
        mass = min(max(mass, least * self.parameters.m_0), most * self.parameters.m_0)
        velocity = estimate.x[self.layout.v_0]
        drag_before, uav_drag_before = _drag(load.air, velocity)
        # What one of the UAVs has of its own is no wind.
        self.wind.learn(estimate.force, _median(estimate.uav_force), velocity)
        limit = self._weight * (self.settings.force_limit if self.wind.air is None else self.settings.drag_limit)
        drag, uav_drag = _drag(self.wind.air, velocity)
        force = load.force + drag_before - drag
        force += share * (self._bounded(estimate.force, limit, mass) - drag - force)
        uav_force = followed(load.uav_force, estimate.uav_force, uav_drag_before, uav_drag, share, self._uav_limit)
        self.estimate = Load(mass, force, uav_force, self.wind.air)

    def _bounded(self, force: Array, level_max: float, mass: float) -> Array:
        """Return a disturbance ``force`` (3,), its level part and the weight of a payload of ``mass`` within limits.

        At hover a wrong mass is a vertical force, and what a payload suddenly loses appears as one for long.
        """
        least, most = self.settings.mass_share
        own = mass * self.parameters.g
        x, y, z = force.tolist()
        scale = level_max / max(math.hypot(x, y), level_max)
        return np.array([scale * x, scale * y, min(max(own + z, least * self._weight), most * self._weight) - own])


def _drag(air: Air | None, velocity: Array) -> tuple[Array, Array]:
    """Return the drag on the payload and on each UAV (3,) (N), at ``velocity`` (3,) (m/s)."""
    return (np.zeros(3), np.zeros(3)) if air is None else (air.on_payload(velocity), air.on_uav(velocity))


def _median(vectors: Array) -> Array:
    """Return the median (3,) of finite ``vectors`` (N, 3), axis by axis."""
    half = len(vectors) // 2
    ordered = [sorted(values) for values in zip(*vectors.tolist(), strict=True)]
    return np.array([(values[half] + values[~half]) / 2.0 for values in ordered])
