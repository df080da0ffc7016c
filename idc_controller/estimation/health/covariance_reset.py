"""Covariance of the estimate at the start, and what is added where sound measurements contradict a prediction."""

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.process_model import ProcessModel
from idc_controller.estimation.settings import CovarianceResetSettings, InitialCovarianceSettings


def initial_covariance(process: ProcessModel, settings: InitialCovarianceSettings) -> Array:
    """Return the covariance (n, n) of the whole state of a team on the ground."""
    layout = process.layout
    sigma = np.empty(process.size)
    sigma[layout.r_0], sigma[layout.v_0] = settings.position, settings.velocity
    sigma[layout.Theta], sigma[layout.omega] = settings.attitude, settings.rates
    sigma[layout.s], sigma[layout.s_dot] = settings.link, settings.link_rate
    sigma[layout.n], sigma[layout.n_dot] = settings.thrust_direction, settings.thrust_direction_rate
    sigma[layout.n_acc] = settings.thrust_direction_acceleration
    sigma[layout.f] = settings.thrust
    sigma[process.force], sigma[process.mass] = settings.force, settings.mass
    sigma[process.uav_force] = 0.0
    P = np.diag(sigma**2)
    P[process.uav_force, process.uav_force] = process.uav_forces(settings.uav_force, settings.per_vehicle_force)
    return P


def reset_covariance(process: ProcessModel, P: Array, settings: CovarianceResetSettings) -> Array:
    """Return what is added (n, n) to ``P`` (n, n) where most measurements contradict the prediction.

    A blow or a gust changes velocities and forces, not positions; added at every moment at which they contradict it.
    """
    layout, force = process.layout, process.force
    added = np.zeros(process.size)
    added[layout.v_0], added[layout.omega] = settings.velocity**2, settings.rates**2
    added[layout.s_dot] = settings.link_rate**2
    added[force] = np.maximum(settings.force**2 - np.diag(P)[force], 0.0)
    return np.diag(added)
