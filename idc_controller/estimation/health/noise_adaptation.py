"""Innovation test of the measurements of one moment, and adaptation of measurement and process noise to it.

Innovations normalised by their covariance have variance 1 and are uncorrelated in time. Where most are larger without
correlation, the sensors are noisier than assumed; where they keep pointing the same way, forces change faster than
assumed (gusts, a load that is lost).

The process noise is that of all forces. Without the positions of several UAVs only the payload shows forces, not which:
with more noise the links would be estimated after the noise of its measurements. Then it remains as assumed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Mask
from idc_controller.estimation.kalman_filter import Innovation
from idc_controller.estimation.measurement_model import ObservationStack
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position, SensorKey
from idc_controller.estimation.settings import NoiseAdaptationSettings
from idc_controller.estimation.update_kernels import gated, mean_products


class InnovationTest(NamedTuple):
    """Result for K measurements with m rows in all."""

    variance: Array
    """Measurement variance assumed now (m,)."""
    normalised: Array
    """Innovations normalised to variance 1 (m,)."""
    mean_squares: Array
    """Mean square of each measurement's normalised innovation (K,); on average 1."""
    accepted: Mask
    """Measurements that pass (K,)."""
    accepted_rows: Mask
    """Rows (m,) of accepted measurements, and of the channels that pass alone in rejected ones."""
    ratios: Array
    """Test ratios of pose and motion (K, 2): above 1 they are rejected; equal where one of them alone is tested."""

    @classmethod
    def of(cls, innovation: Innovation, stack: ObservationStack, noise_scale: float, gates: Array) -> InnovationTest:
        """Return the test of the measurements of one moment.

        Args:
            innovation: theirs.
            stack: the measurements.
            noise_scale: of their variances.
            gates: normalised innovation squared up to which a measurement passes, by its size (7,).
        """
        variance = stack.variance * noise_scale
        return cls(
            variance, *gated(innovation.residual, innovation.covariance, variance, stack.starts, stack.sizes, gates)
        )


class Reaction(Enum):
    """Reaction of the filter to rejected measurements."""

    NONE = "none"
    COVARIANCE_RESET = "covariance reset"
    NOISE_INFLATION = "noise inflation"


class NoiseAdaptation:
    """Learns from the normalised innovations of one moment after the other."""

    def __init__(self, payload_rejections: int, settings: NoiseAdaptationSettings = NoiseAdaptationSettings()) -> None:
        """``payload_rejections``: rejections of the payload unit in a row after which the prediction is at fault."""
        self._settings, self._payload_rejections_max = settings, payload_rejections
        self.measurement_scale = 1.0
        """Scale of the measurement variances, 1 or more."""
        self.level = 0
        """Level of the forces' process noise, 0 to ``process_levels``."""
        self._time = -np.inf
        self._keys: Sequence[SensorKey] = ()
        self._forces_shown = -np.inf
        """Time of the last measurements that tell the forces on the UAVs from each other."""
        self._last = np.zeros(0)
        self._correlation = 0.0, 0.0
        """Mean correlation of the innovations of the payload unit and of the UAVs."""
        self._since_change = 0
        self._payload_rejections = 0

    def copy(self) -> NoiseAdaptation:
        """Return one in the same state, which learns on by itself."""
        other = NoiseAdaptation.__new__(NoiseAdaptation)  # a tenth of the time of copy.copy
        vars(other).update(vars(self))
        return other

    @property
    def process_scale(self) -> float:
        """Scale of the densities of the forces' process noise."""
        return float(self._settings.process_step**self.level)

    @property
    def is_at_limit(self) -> bool:
        """Return whether the process noise is at its highest level."""
        return self.level >= self._settings.process_levels

    def react(self, time: float, keys: Sequence[SensorKey], test: InnovationTest) -> Reaction:
        """Return how the filter reacts to rejections, and inflate the measurement noise where that is the reaction.

        Sensors rarely fail simultaneously, so most sources of three or more are right. The payload unit, which measures
        a disturbance of the payload first, is right when it persists. Otherwise a filter that kept to its prediction
        would reject every measurement from here on.
        """
        if False not in test.accepted.tolist():
            self._payload_rejections = 0
            return Reaction.NONE
        sources = {source for source, _ in keys}
        rejected = {source for (source, _), good in zip(keys, test.accepted, strict=True) if not good}
        if PAYLOAD in sources:
            self._payload_rejections = self._payload_rejections + 1 if PAYLOAD in rejected else 0
        by_most = len(sources) >= 3 and 2 * len(rejected) > len(sources)
        by_payload = self._payload_rejections >= self._payload_rejections_max
        if by_payload or (by_most and self._persists(time, keys, test.normalised)):
            return Reaction.COVARIANCE_RESET
        if not by_most:
            return Reaction.NONE
        limit = self._settings.measurement_scale_max
        growth = float(np.clip(np.median(test.mean_squares), 1.0, limit))
        self.measurement_scale = min(self.measurement_scale * growth, limit)
        return Reaction.NOISE_INFLATION

    def learn(
        self, time: float, keys: Sequence[SensorKey], normalised: Array, mean_squares: Array,
        accepted: Mask, of_payload: Mask,
    ) -> None:  # fmt: skip
        """Learn from the K measurements of one moment.

        Args:
            time: s.
            keys: the measurements.
            normalised: their normalised innovations (m,).
            mean_squares: mean square of each (K,).
            accepted: rows that were accepted (m,).
            of_payload: rows of the payload unit (m,).
        """
        s = self._settings
        # A correlated part is no noise.
        ordered = sorted(mean_squares.tolist())
        middle = len(ordered) // 2
        median = (ordered[middle] + ordered[~middle]) / 2.0 - max(*self._correlation, 0.0)
        if median > s.median_limit and not self._persists(time, keys, normalised):
            self.measurement_scale = min(self.measurement_scale * s.growth, s.measurement_scale_max)
        elif median < 1.0:
            self.measurement_scale = max(self.measurement_scale * s.decay, 1.0)
        if self._follows(time, keys, normalised):
            products = mean_products(normalised, self._last, accepted, of_payload)
            self._correlation = (
                self._mean_correlation(self._correlation[0], products[0]),
                self._mean_correlation(self._correlation[1], products[1]),
            )
            self._since_change += 1
            correlation = max(self._correlation)
            if self._since_change > s.dwell and correlation > s.correlation_rise and self.level < s.process_levels:
                self.level, self._since_change = self.level + 1, 0
            elif self._since_change > s.dwell and correlation < s.correlation_fall and self.level:
                self.level, self._since_change = self.level - 1, 0
        if _without_position(keys) < 2:
            self._forces_shown = time
        elif time - self._forces_shown > s.gap:
            self.level, self._correlation = 0, (0.0, 0.0)
        self._time, self._keys, self._last = time, keys, normalised

    def _mean_correlation(self, mean: float, product: float) -> float:
        """Return the running ``mean`` with the mean ``product`` of one update; nan: it has none."""
        s = self._settings
        if math.isnan(product):
            return mean
        return mean + s.correlation_share * (min(max(product, -s.correlation_max), s.correlation_max) - mean)

    def _persists(self, time: float, keys: Sequence[SensorKey], normalised: Array) -> bool:
        """Return whether the innovation (m,) points where the last one pointed."""
        if not self._follows(time, keys, normalised):
            return False
        product = float(normalised @ self._last)
        limit = self._settings.persistent_cosine
        return product > limit * float(np.linalg.norm(normalised) * np.linalg.norm(self._last))

    def _follows(self, time: float, keys: Sequence[SensorKey], normalised: Array) -> bool:
        return (
            keys == self._keys and len(normalised) == len(self._last) and 0.0 < time - self._time <= self._settings.gap
        )


def _without_position(keys: Sequence[SensorKey]) -> int:
    """Return of how many UAVs there is an attitude, but no position."""
    attitudes = {source for source, kind in keys if kind is Attitude and source != PAYLOAD}
    return len(attitudes.difference(source for source, kind in keys if kind is Position))
