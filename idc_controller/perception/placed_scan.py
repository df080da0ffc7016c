"""A scan in the world: its returns, its rays without return, and how sure they are."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from idc_controller.arrays import Array
from idc_controller.perception.voxel_kernels import Rays


def _none() -> Array:
    return np.empty((0, 3))


def _up() -> Array:
    return np.array([0.0, 0.0, -1.0])


@dataclass(frozen=True, eq=False)
class PlacedScan:
    """Returns and rays without return of one scan. SI units, NED; times are the team's (s).

    Each return lies on the first surface of its ray; nothing says to which obstacle it belongs. The noise of a return
    is kept as three standard deviations, of which its covariance follows: along the ray, of the position on every axis,
    and across the ray by the attitude.
    """

    time: float
    origin: Array
    """Place of the sensor (3,)."""
    returns: Array
    """Points that rays hit (n, 3)."""
    range_sigma: float
    """Standard deviation of a return along its ray (m)."""
    position_sigma: float
    """Standard deviation of the vehicle's position, every axis (m); larger where returns do not lie on the rays."""
    attitude_sigma: float
    """Standard deviation of its attitude, every axis (rad)."""
    free_rays: Array = field(default_factory=_none)
    """Ends of the rays that returned nothing up to there (m, 3): at the sensor's range, or above the ground, which
    vehicles leave out of their returns; none where returns may have been lost.

    A ray may also return nothing by chance, by the sensor's missed share.
    """
    uav: int = 0
    """The vehicle (0 .. N-1)."""
    up: Array = field(default_factory=_up)
    """Upward axis of its body frame (3,)."""

    @cached_property
    def distances(self) -> Array:
        """Of the returns from the sensor (n,) (m)."""
        return np.asarray(np.linalg.norm(self.returns - self.origin, axis=1))

    @cached_property
    def pose_variance(self) -> Array:
        """Variance of each return from the pose, on every axis (n,) (m2)."""
        return np.asarray(self.position_sigma**2 + (self.attitude_sigma * self.distances) ** 2)

    @cached_property
    def sigma(self) -> Array:
        """Largest standard deviation of each return (n,) (m)."""
        square = self.range_sigma**2 + self.position_sigma**2 + (self.attitude_sigma * self.distances) ** 2
        return np.asarray(np.sqrt(square))

    @cached_property
    def rays(self) -> Rays:
        """What kernels take of the scan."""
        sigmas = np.array([self.range_sigma, self.position_sigma, self.attitude_sigma])
        origin, returns, free = map(np.ascontiguousarray, (self.origin, self.returns, self.free_rays))
        return Rays(origin, returns, free, sigmas)
