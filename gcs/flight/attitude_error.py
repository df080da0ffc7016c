"""Vehicles whose thrust does not pull where the attitude that they report says, by their motion."""

import numpy as np

from gcs.flight.condition import Moment, System, Trigger


def attitude_wrong(system: System, moment: Moment) -> Trigger | None:
    """Return the vehicle whose attitude is wrong on board by more than the limit; None: none is.

    A vehicle that flies by a wrong attitude pulls aside by its thrust times the error. The filter takes that for a
    disturbance force of this vehicle's own; wind acts on all of them.
    """
    if moment.estimate is None or not system.payload.is_clear(moment.estimate):
        return None
    forces = np.asarray(moment.estimate.uav_force)[:, :2]
    own = np.linalg.norm(forces - np.median(forces, axis=0), axis=1)
    errors = own / system.team.parameters.hover_thrust
    worst = int(np.argmax(errors))
    error, limit = float(errors[worst]), system.settings.attitude_error
    if not error > limit:  # a force that is not a number is another failsafe's
        return None
    name = system.team.links[worst].system_id
    return Trigger(f"the thrust of vehicle {name} is {error:.2f} rad off its attitude (limit {limit:g} rad)", (worst,))
