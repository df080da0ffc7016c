"""Measurement update: innovations of one moment, their test, and the correction of the filter."""

from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.estimation.health.chi_squared import lower_quantile
from idc_controller.estimation.health.noise_adaptation import InnovationTest, Reaction
from idc_controller.estimation.health.sensor_health import SensorHealth
from idc_controller.estimation.measurement_model import MeasurementModel, ObservationStack
from idc_controller.estimation.measurements import InnovationRecord, Measurement, Position, SensorKey, median_of
from idc_controller.estimation.propagation import ErrorStateFilter
from idc_controller.estimation.settings import EstimatorSettings
from idc_controller.trajectory.flatness import FlatReference


@dataclass
class Moment:
    """Measurements of one ``time`` (s) by source and kind; of the payload with all relayed copies."""

    time: float
    measurements: dict[SensorKey, list[Measurement]]


class MeasurementUpdate:
    """Corrects a filter by the measurements of one moment after the other."""

    def __init__(self, model: MeasurementModel, health: SensorHealth, settings: EstimatorSettings) -> None:
        self._model, self._health, self._settings = model, health, settings
        self._gates = lower_quantile(settings.gate_probability, np.arange(7))
        """Normalised innovation squared that a nominal measurement does not exceed, by its size."""

    def apply(
        self, filter: ErrorStateFilter, moment: Moment, flat: FlatReference, k: int, adapt: bool
    ) -> InnovationRecord | None:
        """Correct ``filter`` by the measurements of ``moment``.

        Args:
            filter: predicted to that time.
            moment: the measurements.
            flat: the reference.
            k: index of that time in the reference.
            adapt: whether covariance, noise and isolation may adapt to rejections.

        Returns:
            The innovation test; None where no measurement may be used.
        """
        health, model = self._health, self._model
        is_lost = not filter.is_finite
        if is_lost:
            self._restart(filter)
        measurements = [median_of(copies) for copies in moment.measurements.values()]
        observation = model.observation(tuple(moment.measurements))
        whole = observation.stack
        samples = observation.samples(measurements)
        health.dead_reckoning.add(samples)
        if health.isolated_groups:
            samples = observation.samples([health.usable(measurement) for measurement in measurements])
        innovation = model.innovation(observation, samples, flat, k, filter.x, filter.P)
        present = health.usable_rows(whole, innovation)
        usable = int(np.count_nonzero(present))
        if not usable:
            return None
        stack = whole
        if usable < len(present):
            stack, innovation = whole.subset(present), innovation.subset(present)
        keys, adaptation = stack.keys, health.adaptation
        test = InnovationTest.of(innovation, stack, adaptation.measurement_scale, self._gates)
        reaction = adaptation.react(moment.time, keys, test) if adapt else Reaction.NONE
        if reaction is Reaction.COVARIANCE_RESET:
            filter.inflate(filter.process.covariance_reset(filter.P, self._settings.reset))
            innovation = model.innovation(observation, samples, flat, k, filter.x, filter.P)
            innovation = innovation if stack is whole else innovation.subset(present)
        if reaction is not Reaction.NONE:
            test = InnovationTest.of(innovation, stack, adaptation.measurement_scale, self._gates)
        accepted = test.accepted_rows
        rejected = [c for c, good in enumerate(test.accepted.tolist()) if not good]
        poses = [keys[c] for c in rejected if keys[c][1] is Position or not accepted[stack.starts[c]]]
        health.rejected(moment.time, poses)
        accepted_of_all = accepted
        if stack is not whole:
            accepted_of_all = present.copy()
            accepted_of_all[present] = accepted
        if adapt:
            health.isolation.learn(whole, present, accepted_of_all, health.dead_reckoning.is_inconsistent)
            adaptation.learn(moment.time, keys, test.normalised, test.mean_squares, accepted, stack.of_payload)
        squared, degrees_of_freedom = 0.0, int(np.count_nonzero(accepted))
        if degrees_of_freedom:
            variance, measured = test.variance, observation.uavs
            if degrees_of_freedom < len(present):
                heights = observation.heights
                measured = measured[accepted_of_all[heights] & accepted_of_all[heights + 3]]
            if degrees_of_freedom < usable:
                innovation, variance = innovation.subset(accepted), variance[accepted]
            squared = filter.apply(innovation, variance, measured)
        ratios = test.ratios if stack is whole else _of_channels_present(test.ratios, whole, present)
        return InnovationRecord(
            moment.time, squared, degrees_of_freedom, tuple(keys[c] for c in rejected),
            is_lost or reaction is Reaction.COVARIANCE_RESET, keys, stack.sizes, test.normalised, ratios,
        )  # fmt: skip

    def _restart(self, filter: ErrorStateFilter) -> None:
        """Begin anew from the reference where the state is no number: nothing that is measured could mend it."""
        P = filter.process.initial_covariance(self._settings.initial)
        filter.restart(P + filter.process.covariance_reset(P, self._settings.reset))


def _of_channels_present(ratios: Array, whole: ObservationStack, present: Mask) -> Array:
    """Return test ratios (K, 2) with nan for a pose or a motion that is not among the rows ``present`` (m,)."""
    measured = np.column_stack([present[whole.starts], present[whole.starts + whole.sizes // 2]])
    return np.where(measured[measured.any(axis=1)], ratios, np.nan)
