"""Accelerometers of the payload's unit and of the vehicles: which are driven out of their range, as by an impact."""

import math

from vehicle_sim.world.readings import Readings

RANGE = 8.0 * 9.80665
"""m/s2: full scale of the accelerometers, one of those that IMUs offer (8 g).

The engine stops a part within one step: a contact of more than about 0.2 m/s exceeds it.
"""


def clipped(readings: Readings, gravity: float, physics_hz: int) -> list[int]:
    """Return whose specific force exceeded the range in the last step: 0 the payload's, 1 .. N the vehicles'."""
    forces = [
        math.hypot(x * physics_hz, y * physics_hz, z * physics_hz + gravity) for x, y, z in readings.velocity_changes()
    ]
    return [i for i, force in enumerate(forces) if force > RANGE]
