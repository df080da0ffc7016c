"""The stop plan: how every UAV comes to rest, together with the others, when it receives no set-points.

All of them start from one moment of one reference and take the same time, so the payload stays level without messages
between them. Along each axis the position is the quartic that takes over position, velocity and acceleration and ends
without velocity and acceleration; a quartic is a Bezier curve of five control points, as many as fit into a message.

In wind the team is not where the reference has it. The plan starts where the team is: all of it is moved alike, so
that no UAV is biased towards a place that the payload was meant to have.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.interpolate import BPoly

from idc_controller.arrays import Array
from idc_controller.model.linear import E3, StateLayout
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.flatness import FlatReference
from idc_controller.trajectory.settings import BrakingSettings

# Control points of the quartic from (position, T velocity, T^2 acceleration) at its start.
_CONTROL_POINTS = np.array(
    [
        [1.0, 0.0, 0.0],
        [1.0, 1.0 / 4.0, 0.0],
        [1.0, 1.0 / 2.0, 1.0 / 12.0],
        [1.0, 1.0 / 2.0, 1.0 / 12.0],
        [1.0, 1.0 / 2.0, 1.0 / 12.0],
    ]
)


class Braking(NamedTuple):
    """A stop; by default in the usual time, to where the motion leads."""

    share: float = 1.0
    """Duration over the usual one."""
    aside: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Place of rest less that to which the motion alone leads (m). The acceleration then jumps at the start."""
    settings: BrakingSettings = BrakingSettings()

    def duration(self, velocity: Array) -> float:
        """Return the time from a ``velocity`` (3,) (m/s) to rest (s)."""
        speed = float(np.linalg.norm(velocity))
        return self.share * max(self.settings.time, 1.5 * speed / self.settings.deceleration)

    def control_points(self, state: Array, duration: float) -> Array:
        """Return those (..., 5, 3) (m) of the path from a ``state`` (..., 3, 3) of position, velocity, acceleration."""
        points = _CONTROL_POINTS @ (state * np.array([1.0, duration, duration**2])[:, None])
        points[..., 2:, :] += np.array(self.aside)
        return np.asarray(points)

    def path(self, state: Array) -> BPoly:
        """Return the path from ``state`` (3, 3) on, over the time since then (s)."""
        duration = self.duration(state[1])
        return BPoly(self.control_points(state, duration)[:, None, :], [0.0, duration])


@dataclass(frozen=True, eq=False)
class StopPlan:
    """Bezier curves that bring all UAVs to rest, over the same ``duration`` (s) from the same ``start`` (s)."""

    start: float
    duration: float
    control_points: Array
    """(N, 5, 3) (m, NED)."""


def stop_plan(
    parameters: SystemParameters,
    flat: FlatReference,
    time: float,
    x: Array | None = None,
    choose: Callable[[float, Array], Braking] = lambda time, state: Braking(),
) -> StopPlan:
    """Return the stop plan from the first instant of the reference ``flat``, which is ``time`` (s).

    ``x`` (12 + 11 N,) is the state then; None: that of the reference. ``choose`` says how to brake, by the time and
    position, velocity and acceleration (3, 3) of a payload that hangs at rest below the UAVs.
    """
    links = flat.links
    position, velocity, acceleration = flat.payload[:3, 0]
    if x is not None and np.all(np.isfinite(x)):
        off = _beside(parameters, x - flat.x[0])
        position, velocity = position + off[0], velocity + off[1]
    l = parameters.l[:, None]
    state = np.stack(
        [
            position + parameters.p - l * links.q[0],
            velocity - l * links.q_dot[0],
            acceleration - l * links.q_ddot[0],
        ],
        axis=1,
    )  # (N, 3, 3)
    # The UAVs come to rest by their own motion, and the payload below them, which may swing now.
    below = state.mean(axis=0)
    below[0] -= parameters.p.mean(axis=0) - parameters.l.mean() * E3
    braking = choose(time, below)
    duration = braking.duration(below[1])
    return StopPlan(time, duration, braking.control_points(state, duration))


def _beside(parameters: SystemParameters, error: Array) -> Array:
    """Position and velocity (2, 3) of the UAVs' centre beside the reference's: the mean of r_0 - l_i s_i."""
    layout = StateLayout(parameters.number_of_uavs)
    off = np.array([error[layout.r_0], error[layout.v_0]])
    for row, tilt in zip(off, (layout.s, layout.s_dot), strict=True):
        row[:2] -= np.mean(parameters.l[:, None] * error[tilt].reshape(-1, 2), axis=0)
    return off
