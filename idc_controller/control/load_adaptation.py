"""The load that the reference is made for: payload mass, disturbance forces and wind, learnt from the estimates."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.control.force_kernels import followed
from idc_controller.control.settings import ControllerSettings
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
        self._uav_limit = settings.force_limit * float(self.parameters.m.min()) * self.parameters.g
        self.estimate = Load(self.parameters.m_0, np.zeros(3), np.zeros((self.parameters.number_of_uavs, 3)))
        self.wind = WindEstimator(
            self.parameters.payload.areas, settings.period, settings.drag_limit * self._weight, settings.wind
        )

    def release(self) -> None:
        """Let links that lean against the wind come upright: the ground holds the payload."""
        share = self.settings.period / self.settings.upright_time_constant
        load = self.estimate
        drag, uav_drag = _drag(load.air, np.zeros(3))
        self.estimate = Load(load.mass, (1.0 - share) * (load.force + drag), load.uav_force + uav_drag)

    def learn(self, estimate: Estimate) -> None:
        """Follow the disturbance forces and the mass excess of ``estimate``."""
        load = self.estimate
        share = self.settings.period / self.settings.load_time_constant
        mass = load.mass + share * (self.parameters.m_0 + estimate.mass_excess - load.mass)
        velocity = estimate.x[self.layout.v_0]
        drag_before, uav_drag_before = _drag(load.air, velocity)
        # What one of the UAVs has of its own is no wind.
        self.wind.learn(estimate.force, _median(estimate.uav_force), velocity)
        limit = self._weight * (self.settings.force_limit if self.wind.air is None else self.settings.drag_limit)
        drag, uav_drag = _drag(self.wind.air, velocity)
        force = followed(load.force[None], estimate.force[None], drag_before, drag, share, limit)[0]
        uav_force = followed(load.uav_force, estimate.uav_force, uav_drag_before, uav_drag, share, self._uav_limit)
        least, most = self.settings.mass_share
        mass = min(max(mass, least * self.parameters.m_0), most * self.parameters.m_0)
        self.estimate = Load(mass, force, uav_force, self.wind.air)


def _drag(air: Air | None, velocity: Array) -> tuple[Array, Array]:
    """Return the drag on the payload and on each UAV (3,) (N), at ``velocity`` (3,) (m/s)."""
    return (np.zeros(3), np.zeros(3)) if air is None else (air.on_payload(velocity), air.on_uav(velocity))


def _median(vectors: Array) -> Array:
    """Return the median (3,) of finite ``vectors`` (N, 3), axis by axis."""
    half = len(vectors) // 2
    ordered = [sorted(values) for values in zip(*vectors.tolist(), strict=True)]
    return np.array([(values[half] + values[~half]) / 2.0 for values in ordered])
