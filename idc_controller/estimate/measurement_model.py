"""What each measurement says of the state: innovation, rows and noise, about an exact reference."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimate.measurements import PAYLOAD, Attitude, Measurement, MeasurementNoise, Position
from idc_controller.model.linear import LinearModel
from idc_controller.plan.flatness import FlatReference
from idc_controller.rotations import euler_from_quaternion

Array = NDArray[np.float64]

# Even a perfect sensor is believed only to about the model's own error; it also keeps the update well conditioned.
FLOOR = {"position": 2e-3, "velocity": 4e-3, "attitude": 2e-4, "rates": 1e-3}


@dataclass(frozen=True)
class Channel:
    """Rows of one kind of measurement of one source."""

    rows: Array
    """(k, n)"""
    variance: Array
    """(k,)"""


class MeasurementModel:
    """Channels for every source, and measured less reference in the filter's coordinates."""

    def __init__(self, model: LinearModel, noise: MeasurementNoise) -> None:
        layout, N = model.layout, model.layout.number_of_uavs
        self.layout = layout
        self.parameters = model.parameters
        identity = np.eye(layout.size)

        def variance(first: float, floor_first: str, second: float, floor_second: str, axes: int) -> Array:
            sigma = np.repeat([max(first, FLOOR[floor_first]), max(second, FLOOR[floor_second])], axes)
            return sigma**2

        self.channels: dict[tuple[int, type], Channel] = {
            (PAYLOAD, Attitude): Channel(
                np.vstack([identity[layout.Theta], identity[layout.omega]]),
                variance(noise.attitude, "attitude", noise.payload_rates, "rates", 3),
            )
        }
        self.channels[PAYLOAD, Position] = Channel(
            np.vstack([identity[layout.r_0], identity[layout.v_0]]),
            variance(noise.position, "position", noise.payload_velocity, "velocity", 3),
        )
        for i in range(N):
            three, two = slice(3 * i, 3 * i + 3), slice(2 * i, 2 * i + 2)
            self.channels[i, Position] = Channel(
                np.vstack([model.uav_position_rows[three], model.uav_velocity_rows[three]]),
                variance(noise.position, "position", noise.uav_velocity, "velocity", 3),
            )
            self.channels[i, Attitude] = Channel(
                np.vstack([identity[layout.n][two], identity[layout.n_dot][two]]),
                variance(noise.attitude, "attitude", noise.uav_rates, "rates", 2),
            )

    def innovation(self, measurement: Measurement, reference: FlatReference, k: int) -> tuple[Array, Array]:
        """Measured less what the reference's time ``k`` predicts, (m,), and the rows (m, n) that observe the error."""
        i = measurement.source
        rows = self.channels[i, type(measurement)].rows
        if isinstance(measurement, Attitude):
            if i == PAYLOAD:
                return np.concatenate([euler_from_quaternion(measurement.quaternion), measurement.rates]), rows
            # Of a UAV's attitude only the direction of the thrust moves anything: n = -R e3, n' = -R (omega x e3).
            w, x, y, z = measurement.quaternion.tolist()
            p, q, _ = measurement.rates.tolist()
            reference_x, first = reference.x[k], 2 * i
            n, n_dot = self.layout.n.start + first, self.layout.n_dot.start + first
            told = (
                -2.0 * (x * z + w * y),
                -2.0 * (y * z - w * x),
                2.0 * (x * y - w * z) * p - (1.0 - 2.0 * (y * y + z * z)) * q,
                (1.0 - 2.0 * (x * x + z * z)) * p - 2.0 * (x * y + w * z) * q,
            )
            expected = (reference_x[n], reference_x[n + 1], reference_x[n_dot], reference_x[n_dot + 1])
            return np.subtract(told, expected), rows
        position, velocity = reference.payload[0, k], reference.payload[1, k]
        if i != PAYLOAD:
            l, q = self.parameters.l[i], reference.links.q[k]
            position = position + self.parameters.p[i] - l * q
            velocity = velocity - l * reference.links.q_dot[k]
            # The unit length of a tilted link: a change of its lateral part changes its height too.
            slope = l * q[:2] / q[2]
            rows = rows.copy()
            rows[2, self.layout.s.start + 2 * i : self.layout.s.start + 2 * i + 2] = slope
            rows[5, self.layout.s_dot.start + 2 * i : self.layout.s_dot.start + 2 * i + 2] = slope
        return np.concatenate([measurement.position - position, measurement.velocity - velocity]), rows
