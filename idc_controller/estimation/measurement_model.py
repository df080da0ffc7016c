"""Measurement model: innovation, rows and noise of each measurement, about an exact reference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.kalman_filter import Innovation, SparseRows
from idc_controller.estimation.measurements import (
    PAYLOAD,
    Attitude,
    Measurement,
    MeasurementNoise,
    Position,
    SampleStack,
    SensorKey,
    VehicleStates,
)
from idc_controller.estimation.settings import MeasurementModelSettings
from idc_controller.estimation.update_kernels import innovations
from idc_controller.estimation.vehicle_kernels import vehicle_states
from idc_controller.model.linear import LinearModel
from idc_controller.trajectory.flatness import FlatReference

_WIDTH = 5
"""Most elements of a row that are not zero: three, and the two of a tilted link."""


@dataclass(frozen=True, eq=False)
class ObservationStack:
    """Measurements of one moment, one below the other."""

    keys: tuple[SensorKey, ...]
    """Source and kind of each (K,)."""
    variance: Array
    """(m,)"""
    sizes: Indices
    """Rows of each (K,); they add up to m."""
    starts: Indices
    """Their first rows (K,)."""
    of_payload: Mask
    """Rows (m,) of the payload."""

    def subset(self, present: Mask) -> ObservationStack:
        """Return the stack of the rows ``present`` (m,) alone."""
        sizes = np.add.reduceat(present, self.starts, dtype=int)
        left = sizes > 0
        keys = tuple(key for key, some in zip(self.keys, left.tolist(), strict=True) if some)
        sizes = sizes[left]
        return ObservationStack(
            keys, self.variance[present], sizes, np.cumsum(sizes) - sizes, self.of_payload[present]
        )  # fmt: skip


@dataclass(frozen=True, eq=False)
class Observation:
    """How the measurements of one moment observe the state."""

    stack: ObservationStack
    rows: SparseRows
    """Links upright."""
    sources: Indices
    """Source of each (K,)."""
    is_position: Mask
    """Whether each is a position (K,)."""
    uavs: Indices
    """UAVs whose position is observed (P,)."""
    heights: Indices
    """Rows of their heights (P,); those of the vertical velocities are three below."""

    def samples(self, measurements: Sequence[Measurement]) -> SampleStack:
        """Return these measurements (K), one after the other."""
        values = np.concatenate([part for sample in measurements for part in (sample.pose, sample.motion)])
        return SampleStack(np.array([sample.time for sample in measurements]), self.sources, self.is_position, values)


class MeasurementModel:
    """Observations of every source, and measured less reference in the filter's coordinates."""

    def __init__(self, model: LinearModel, noise: MeasurementNoise, floor: MeasurementModelSettings) -> None:
        layout, N = model.layout, model.layout.number_of_uavs
        self.layout = layout
        self.parameters = model.parameters
        identity = np.eye(layout.size)

        def position_variance(velocity: float) -> Array:
            position = max(noise.position, floor.position_noise_min)
            return np.repeat([position, max(velocity, floor.velocity_noise_min)], 3) ** 2

        def attitude_variance(rates: float, axes: int) -> Array:
            attitude = max(noise.attitude, floor.attitude_noise_min)
            return np.repeat([attitude, max(rates, floor.rates_noise_min)], axes) ** 2

        self.observations: dict[SensorKey, tuple[Array, Array]] = {
            (PAYLOAD, Attitude): (
                np.vstack([identity[layout.Theta], identity[layout.omega]]),
                attitude_variance(noise.payload_rates, 3),
            ),
            (PAYLOAD, Position): (
                np.vstack([identity[layout.r_0], identity[layout.v_0]]),
                position_variance(noise.payload_velocity),
            ),
        }
        """Rows (k, n) and variances (k,) of each kind of measurement of each source."""
        for i in range(N):
            three, two = slice(3 * i, 3 * i + 3), slice(2 * i, 2 * i + 2)
            self.observations[i, Position] = (
                np.vstack([model.uav_position_rows[three], model.uav_velocity_rows[three]]),
                position_variance(noise.uav_velocity),
            )
            self.observations[i, Attitude] = (
                np.vstack([identity[layout.n][two], identity[layout.n_dot][two]]),
                attitude_variance(noise.uav_rates, 2),
            )
        # Orders of arrival are many where links lose and delay: those of late are kept.
        self.observation = lru_cache(maxsize=256)(self._observation)

    def _observation(self, keys: tuple[SensorKey, ...]) -> Observation:
        """Return how these sensors observe the state."""
        observations = [self.observations[key] for key in keys]
        sizes = np.array([len(variance) for _, variance in observations])
        starts = np.cumsum(sizes) - sizes
        sources, is_position = np.array([i for i, _ in keys]), np.array([kind is Position for _, kind in keys])
        variance = np.concatenate([variance for _, variance in observations])
        stack = ObservationStack(keys, variance, sizes, starts, np.repeat(sources == PAYLOAD, sizes))
        of_uav = is_position & (sources != PAYLOAD)
        uavs, heights = sources[of_uav], starts[of_uav] + 2
        rows = np.vstack([rows for rows, _ in observations])
        sparse = SparseRows.of(rows, _WIDTH)
        for below, part in ((0, self.layout.s), (3, self.layout.s_dot)):
            sparse.columns[heights + below, -2:] = part.start + 2 * uavs[:, None] + np.arange(2)
        return Observation(stack, sparse, sources, is_position, uavs, heights)

    def innovation(
        self, observation: Observation, samples: SampleStack, reference: FlatReference, k: int, x: Array, P: Array
    ) -> Innovation:
        """Return the innovation of ``samples`` at the reference's time ``k``; nan where nothing was measured.

        ``x``: error about the reference that is predicted for then (n,), and ``P``: its covariance (n, n).
        """
        links, p, stack, (columns, coefficients) = reference.links, self.parameters, observation.stack, observation.rows
        coefficients, residual, covariance = innovations(
            samples.values, samples.sources, samples.is_position, reference.x, reference.payload, links.q, links.q_dot,
            k, p.p, p.l, columns, coefficients, observation.uavs, observation.heights, stack.starts, stack.sizes, x, P,
        )  # fmt: skip
        return Innovation(SparseRows(columns, coefficients), residual, covariance)

    def vehicles(self, time: float, x: Array) -> VehicleStates:
        """Return the UAVs in the state ``x`` (n,) at ``time`` (s), heading north."""
        layout, p = self.layout, self.parameters
        links = x[layout.s.start : layout.s_dot.stop]
        return VehicleStates(time, vehicle_states(x[:12], links, x[layout.n], x[layout.n_dot], p.p, p.l))
