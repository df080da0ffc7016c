"""The stop plan: how every UAV comes to rest, together with the others, when it receives no set-points.

All of them start from one moment of one reference and take the same time, so the payload stays level without messages
between them. Along each axis the position is the quartic that takes over position, velocity and acceleration and ends
without velocity and acceleration; a quartic is a Bezier curve of five control points, as many as fit into a message.

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

_layout = cache(StateLayout)
_BINOMIALS, _POWERS = np.array([1.0, 4.0, 6.0, 4.0, 1.0]), np.arange(5)
"""Of the Bernstein polynomials of a quartic."""


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


class StopPlan(NamedTuple):
    """Bezier curves that bring all UAVs to rest, over the same ``duration`` (s) from the same ``start`` (s)."""

    start: float
    duration: float
    control_points: Array
    """(N, 5, 3) (m, NED)."""
    descent: float = math.inf
    """Time at which all UAVs descend (s)."""

    def payload_positions(self, parameters: SystemParameters, elapsed: Array) -> Array:
        """Return where a level payload that hangs at rest below the UAVs is (K, 3) (m, NED), by their mean.

        Args:
            parameters: of the system.
            elapsed: times since the start (K,) (s); before it, and after the duration, the UAVs rest.
        """
        points = (self.control_points - parameters.p[:, None]).mean(axis=0)
        points[:, 2] += parameters.l.mean()
        share = np.clip(elapsed / self.duration, 0.0, 1.0)[:, None]
        return np.asarray((_BINOMIALS * share**_POWERS * (1.0 - share) ** _POWERS[::-1]) @ points)


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
    layout, links = _layout(parameters.number_of_uavs), flat.links
    error = np.zeros(layout.size) if x is None or not math.isfinite(x @ x) else x - flat.x[0]
    number, p, l = parameters.number_of_uavs, parameters.p, parameters.l[:, None]
    # All UAVs are beside the reference by what their centre is, the mean of r_0 - l_i s_i.
    beside = np.array([error[layout.r_0], error[layout.v_0]])
    tilts = np.array([error[layout.s], error[layout.s_dot]]).reshape(2, -1, 2)
    beside[:, :2] -= (l * tilts).sum(axis=1) / number
    # The UAVs come to rest by their own motion, and the payload below them, which may swing now.
    state = np.empty((number, 3, 3))
    state[:] = flat.payload[:3, 0]
    state[:, :2] += beside
    state[:, 0] += p
    state -= l[..., None] * np.array([links.q[0], links.q_dot[0], links.q_ddot[0]])
    hung = state.copy()
    hung[:, 0] -= p
    hung[:, 0, 2] += parameters.l
    below = (hung / number).sum(axis=0)
    braking = choose(time, below)
    duration = braking.duration(below[1])
    return StopPlan(time, duration, control_points(state, np.array([duration]), np.array([braking.aside])))


def control_points(states: Array, durations: Array, asides: Array) -> Array:
    """Return the control points (P, 5, 3) (m) of paths to rest: quartics as Bezier curves.

    Args:
        states: position, velocity and acceleration at the start of each path (P, 3, 3); or of all of them (1, 3, 3).
        durations: of the paths (P,) (s); or of all of them (1,).
        asides: place of rest less that to which the motion alone leads (P, 3) (m); (1, 3) with one duration.
    """
    position, times = states[:, 0], durations[:, None]
    turn, bend = times * states[:, 1], times**2 * states[:, 2]
    points = np.empty((len(turn), 5, 3))
    points[:, 0], points[:, 1] = position, position + turn / 4.0
    points[:, 2:] = (position + turn / 2.0 + (1.0 / 12.0) * bend + asides)[:, None]
    return points
