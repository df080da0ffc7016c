"""A scan of a range sensor, placed in the world: what the standing map takes."""

from dataclasses import dataclass

from idc_controller.arrays import Array


@dataclass(frozen=True, eq=False)
class PlacedScan:
    """Returns of one scan of one vehicle, and its rays that returned nothing, in the world (NED, m).

    Each return lies on the first surface of its ray: what is between origin and return was seen free. Nothing says to
    which obstacle a return belongs.
    """

    uav: int
    """The vehicle (0 .. N-1)."""
    time: float
    """When the scan was made (s, team time)."""
    origin: Array
    """Position of the sensor (3,)."""
    returns: Array
    """Where rays met a surface (n, 3), measured."""
    return_variance: Array
    """Covariance of each return (n, 3, 3) (m2): noise along its ray, and errors of the vehicle's position and attitude.

    The errors of the pose are common to all returns of a scan.
    """
    free_rays: Array
    """Ends (m, 3) of the rays without a return: at the sensor's range, or above the ground, which the vehicle leaves
    out of its returns.

    A ray may return nothing by chance (the sensor's missed share) though a surface is there. Empty where parts of the
    scan may be lost, as then a ray without a return says nothing.
    """
    position_sigma: float = 0.0
    """Standard deviation of the origin on every axis (m), contained in :attr:`return_variance`."""
    attitude_sigma: float = 0.0
    """Standard deviation of the sensor's attitude about every axis (rad), contained in :attr:`return_variance`."""
