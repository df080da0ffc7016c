"""Vehicles whose attitude is wrong on board: by their motion in the air, by the pad on the ground."""

from statistics import NormalDist

import numpy as np

from gcs.flight.condition import Moment, System, Trigger
from gcs.flight.phase import Phase
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import Estimate


def attitude_wrong(system: System, moment: Moment) -> Trigger | None:
    """Return the vehicle whose attitude is wrong on board by more than the limit, with the required certainty.

    A vehicle that flies by a wrong attitude pulls aside by its thrust times the error. The filter takes that for a
    disturbance force of this vehicle's own; wind acts on all of them. What the filter does not know of that force, by
    its covariance, is in the vehicle's favour.
    """
    if moment.estimate is None or not system.payload.is_clear(moment.estimate):
        return None
    forces = np.asarray(moment.estimate.uav_force)[:, :2]
    own = forces - np.median(forces, axis=0)
    hover, s = system.team.parameters.hover_thrust, system.settings
    errors = np.linalg.norm(own, axis=1) / hover
    worst = int(np.argmax(errors))
    error, limit = float(errors[worst]), s.attitude_error
    if not error > limit:  # a force that is not a number is another failsafe's
        return None
    deviation = _own_deviation(moment.estimate, worst, own[worst] / np.linalg.norm(own[worst])) / float(hover[worst])
    if not error - NormalDist().inv_cdf(s.attitude_certainty) * deviation > limit:
        return None
    name = system.team.links[worst].system_id
    return Trigger(f"the thrust of vehicle {name} is {error:.2f} rad off its attitude (limit {limit:g} rad)", (worst,))


def _own_deviation(estimate: Estimate, uav: int, direction: Array) -> float:
    """Return the standard deviation (N) along a ``direction`` (2,) of a UAV's force less the mean of the others'."""
    number = len(estimate.uav_force)
    shares = np.full(number, -1.0 / (number - 1))
    shares[uav] = 1.0
    along = np.kron(shares, direction)
    end = len(estimate.covariance) - 1  # the last one is the mass excess
    covariance = estimate.covariance[end - len(along) : end, end - len(along) : end]
    return float(np.sqrt(along @ covariance @ along))


def attitude_misaligned(system: System, moment: Moment) -> Trigger | None:
    """Return the vehicle on the ground whose attitude is wrong.

    Taken off with a wrong attitude it would fall aside with its link, until that is compensated. On the pad the payload
    unit shows it; where it has landed its link leans as it came to rest, and what its attitude has stepped without
    rates counts, in all flights. Once it is lifted from its cradle, it turns against a drift of its attitude: its body
    rates still show that.
    """
    if moment.phase not in (Phase.CHECK, Phase.ARM, Phase.SPOOL_UP):
        return None
    limit, steps, rates = system.settings.pad_attitude_error, system.estimator.attitude_steps, "that by its rates"
    if system.preflight.landed:
        shown = np.linalg.norm(steps.total, axis=1).tolist(), rates
    else:
        shown = system.preflight.attitude_errors(), "the payload's"
        if (least := min(shown[0])) > limit:
            text = f"the payload unit reports an attitude {least:.2f} rad off every vehicle's (limit {limit:g} rad)"
            return Trigger(text, source="payload")
    for errors, right in (shown, (np.linalg.norm(steps.drift, axis=1).tolist(), rates)):
        for i, error in enumerate(errors):
            if error > limit:
                name = f"vehicle {system.team.links[i].system_id}"
                return Trigger(f"{name} reports an attitude {error:.2f} rad off {right} (limit {limit:g} rad)", (i,))
    return None
