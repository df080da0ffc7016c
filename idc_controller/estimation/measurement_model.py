"""Measurement model: innovation, rows and noise of each measurement, about an exact reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, MeasurementNoise, Position, SensorKey
from idc_controller.estimation.settings import MeasurementModelSettings
from idc_controller.model.linear import LinearModel
from idc_controller.rotations import euler_from_quaternion, quaternion_from_euler, rotation_from_quaternion
from idc_controller.trajectory.flatness import FlatReference


@dataclass(frozen=True)
class ObservationStack:
    """Observations of one moment, one below the other."""

    keys: tuple[SensorKey, ...]
    """Source and kind of each (K,)."""
    rows: Array
    """(m, n), links upright."""
    variance: Array
    """(m,)"""
    sizes: Indices
    """Rows of each (K,); they add up to m."""
    starts: Indices
    """Their first rows (K,)."""
    rows_by_size: tuple[Indices, ...]
    """Rows of the observations of one size, (count, size) for each size that there is."""
    of_payload: Mask
    """Rows (m,) of the payload."""
    uavs: Indices
    """UAVs whose position is observed (K,)."""
    heights: Indices
    """Rows of their heights (K,); those of the vertical velocities are three below."""

    def split(self, rows: Array) -> tuple[Array, ...]:
        """Return ``rows`` (m,) by observation."""
        ends = self.starts + self.sizes
        return tuple(rows[a:b] for a, b in zip(self.starts.tolist(), ends.tolist(), strict=True))

    def subset(self, present: Mask) -> ObservationStack:
        """Return the stack of the rows ``present`` (m,) alone; :meth:`MeasurementModel.observe` takes whole ones."""
        sizes = np.add.reduceat(present, self.starts, dtype=int)
        left = sizes > 0
        keys = tuple(key for key, some in zip(self.keys, left.tolist(), strict=True) if some)
        none = np.zeros(0, dtype=int)
        return ObservationStack(
            keys, self.rows[present], self.variance[present],
            *_blocks(sizes[left]), self.of_payload[present], uavs=none, heights=none,
        )  # fmt: skip


def _blocks(sizes: Indices) -> tuple[Indices, Indices, tuple[Indices, ...]]:
    """Return sizes, first rows, and rows by size, of observations one below the other."""
    starts = np.cumsum(sizes) - sizes
    return sizes, starts, tuple(starts[sizes == size][:, None] + np.arange(size) for size in np.unique(sizes))


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
        self._stacks: dict[tuple[SensorKey, ...], ObservationStack] = {}

    def stack(self, keys: tuple[SensorKey, ...]) -> ObservationStack:
        """Return the observations of these sensors."""
        if (found := self._stacks.get(keys)) is None:
            observations = [self.observations[key] for key in keys]
            sizes = np.array([len(variance) for _, variance in observations])
            _, starts, _ = _blocks(sizes)
            tilted = [(i, start + 2) for (i, kind), start in zip(keys, starts.tolist(), strict=True)
                      if kind is Position and i != PAYLOAD]  # fmt: skip
            found = self._stacks[keys] = ObservationStack(
                keys,
                np.vstack([rows for rows, _ in observations]),
                np.concatenate([variance for _, variance in observations]),
                *_blocks(sizes),
                np.repeat([i == PAYLOAD for i, _ in keys], sizes),
                np.array([i for i, _ in tilted], dtype=int),
                np.array([row for _, row in tilted], dtype=int),
            )
        return found

    def observe(self, stack: ObservationStack, reference: FlatReference, k: int, into: Array) -> None:
        """Fill ``into`` (m, n) with the rows that observe the error about the reference's time ``k``."""
        into[:] = stack.rows
        if len(stack.uavs):
            # The unit length of a tilted link: a change of its lateral part changes its height too.
            q = reference.links.q[k]
            slope = np.outer(self.parameters.l[stack.uavs], q[:2] / q[2])
            columns = 2 * stack.uavs[:, None] + np.arange(2)
            into[stack.heights[:, None], self.layout.s.start + columns] = slope
            into[stack.heights[:, None] + 3, self.layout.s_dot.start + columns] = slope

    def innovation(self, measurement: Measurement, reference: FlatReference, k: int) -> Array:
        """Return measured less reference (m,) at the reference's time ``k``; nan where nothing was measured."""
        i = measurement.source
        if isinstance(measurement, Attitude):
            if i == PAYLOAD:
                return np.concatenate([euler_from_quaternion(measurement.quaternion), measurement.rates])
            # Of a UAV's attitude only the direction of the thrust moves anything: n = -R e3, n' = -R (omega x e3).
            w, x, y, z = measurement.quaternion.tolist()
            p, q, _ = measurement.rates.tolist()
            reference_x, first = reference.x[k], 2 * i
            n, n_dot = self.layout.n.start + first, self.layout.n_dot.start + first
            measured = (
                -2.0 * (x * z + w * y),
                -2.0 * (y * z - w * x),
                2.0 * (x * y - w * z) * p - (1.0 - 2.0 * (y * y + z * z)) * q,
                (1.0 - 2.0 * (x * x + z * z)) * p - 2.0 * (x * y + w * z) * q,
            )
            expected = (reference_x[n], reference_x[n + 1], reference_x[n_dot], reference_x[n_dot + 1])
            return np.subtract(measured, expected)
        position, velocity = reference.payload[0, k], reference.payload[1, k]
        if i != PAYLOAD:
            l = self.parameters.l[i]
            position = position + self.parameters.p[i] - l * reference.links.q[k]
            velocity = velocity - l * reference.links.q_dot[k]
        return np.concatenate([measurement.position - position, measurement.velocity - velocity])

    def vehicles(self, time: float, x: Array) -> list[Measurement]:
        """Return positions and attitudes of the UAVs in the state ``x`` (n,) at ``time`` (s), heading north."""
        layout, p, l = self.layout, self.parameters.p, self.parameters.l[:, None]
        attached = p @ rotation_from_quaternion(quaternion_from_euler(*x[layout.Theta])).T
        s, s_dot = _pairs(x[layout.s]), _pairs(x[layout.s_dot])
        down = _third(s)
        position = x[layout.r_0] + attached - l * np.column_stack([s, down])
        sinking = -(s * s_dot).sum(axis=1) / down
        velocity = x[layout.v_0] + np.cross(x[layout.omega], attached) - l * np.column_stack([s_dot, sinking])
        n, n_dot = _pairs(x[layout.n]), _pairs(x[layout.n_dot])
        # Roll and pitch, without a turn from north, that tilt the thrust, along -e3, to (n, -n_z).
        roll, pitch = np.arcsin(n[:, 1]), np.arctan2(-n[:, 0], _third(n))
        (a, b), (c, d) = (np.cos([roll / 2, pitch / 2]), np.sin([roll / 2, pitch / 2]))
        turn = np.column_stack([a * b, c * b, a * d, -c * d])
        # n' = -R (omega x e3), and the heading stays.
        about_x = n_dot[:, 1] / np.cos(roll)
        about_y = (np.sin(pitch) * np.sin(roll) * about_x - n_dot[:, 0]) / np.cos(pitch)
        rates = np.column_stack([about_x, about_y, -np.tan(roll) * about_y])
        positions: list[Measurement] = [Position(time, i, position[i], velocity[i]) for i in range(len(n))]
        return positions + [Attitude(time, i, turn[i], rates[i]) for i in range(len(n))]


def _pairs(values: Array) -> Array:
    return values.reshape(-1, 2)


def _third(lateral: Array) -> Array:
    """Return the third parts of unit vectors with these lateral parts (N, 2)."""
    return np.asarray(np.sqrt(np.maximum(1.0 - (lateral**2).sum(axis=1), 0.01)))
