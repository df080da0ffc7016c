"""The stop plan: how every UAV comes to rest, together with the others, when it receives no set-points.

All of them start from one moment of one reference and take the same time, so the payload stays level without messages
between them. Along each axis the position is the quartic that takes over position, velocity and acceleration and ends
without velocity and acceleration; a quartic is a Bezier curve of five control points, as many as fit into a message.

A landing is not held up: the stop of what sinks ends where the vehicles' own descent is as fast, and that goes on from
the speed at which the payload sinks.

In wind the team is not where the reference has it. The plan starts where the team is: all of it is moved alike, so
that no UAV is biased towards a place that the payload was meant to have.
"""

import math
from collections.abc import Callable
from functools import cache
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array
from idc_controller.model.linear import StateLayout
from idc_controller.parameters import SystemParameters
from idc_controller.trajectory.flatness import FlatReference
from idc_controller.trajectory.settings import BrakingSettings
from idc_controller.trajectory.stop_plan_kernels import control_points, motions_at_rest, on_quartic

_layout = cache(StateLayout)


class Braking(NamedTuple):
    """A stop; by default in the usual time, to where the motion leads."""

    share: float = 1.0
    """Duration over the usual one."""
    aside: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """Place of rest less that to which the motion alone leads (m). The acceleration then jumps at the start."""
    settings: BrakingSettings = BrakingSettings()

    def duration(self, velocity: Array) -> float:
        """Return the time from a ``velocity`` (3,) (m/s) to rest (s)."""
        return self.share * self.settings.usual_duration(velocity)


class Descent(NamedTuple):
    """How the vehicles descend after a stop: to a ``speed`` (m/s), from rest in a time ``ramp`` (s)."""

    speed: float = 0.5
    ramp: float = 1.0


class StopPlan(NamedTuple):
    """Bezier curves that bring all UAVs to rest, over the same ``duration`` (s) from the same ``start`` (s)."""

    start: float
    duration: float
    control_points: Array
    """(N, 5, 3) (m, NED)."""
    descent: float = math.inf
    """Time at which all UAVs descend (s)."""
    hover_forces: Array | None = None
    """Thrusts that hold each UAV at rest (N, 3) (N, NED); None: not known."""

    def payload_positions(self, parameters: SystemParameters, elapsed: Array) -> Array:
        """Return where a level payload that hangs at rest below the UAVs is (K, 3) (m, NED), by their mean.

        Args:
            parameters: of the system.
            elapsed: times since the start (K,) (s); before it, and after the duration, the UAVs rest.
        """
        points = (self.control_points - parameters.p[:, None]).mean(axis=0)
        points[:, 2] += parameters.l.mean()
        return on_quartic(points, np.clip(elapsed / self.duration, 0.0, 1.0))


def stop_plan(
    parameters: SystemParameters,
    flat: FlatReference,
    time: float,
    x: Array | None = None,
    choose: Callable[[float, Array], Braking] = lambda time, state: Braking(),
    landing: Descent | None = None,
) -> StopPlan:
    """Return the stop plan from the first instant of the reference ``flat``, which is ``time`` (s).

    ``x`` (12 + 11 N,) is the state then; None: that of the reference. ``choose`` says how to brake, by the time and
    position, velocity and acceleration (3, 3) of a payload that hangs at rest below the UAVs. ``landing``: the payload
    lands, and goes on so; None: the time of its descent is not known.
    """
    layout, links = _layout(parameters.number_of_uavs), flat.links
    error = np.zeros(layout.size) if x is None or not math.isfinite(x @ x) else x - flat.x[0]
    motions = motions_at_rest(
        flat.payload[:3, 0].copy(), error, np.array([links.q[0], links.q_dot[0], links.q_ddot[0]]),
        parameters.p, parameters.l, layout.s.start, layout.s_dot.start,
    )  # fmt: skip
    # The UAVs come to rest by their own motion, and the payload below them, which may swing now.
    state, below = motions[:-1], motions[-1]
    braking = choose(time, below)
    duration, begun = braking.duration(below[1]), math.inf
    if landing is not None:  # as if it had begun from rest
        begun = min(max(float(below[1, 2]) / landing.speed, 0.0), 1.0) * landing.ramp
    points = control_points(state, np.array([duration]), np.array([braking.aside]))
    return StopPlan(time, duration, points, math.inf if landing is None else time - begun)
