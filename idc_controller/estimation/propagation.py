"""Propagation of the filter's state from its last update to the time of the next set-points."""

from bisect import bisect_left
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Array, Indices
from idc_controller.estimation.kalman_filter import Innovation, StructuredKalmanFilter
from idc_controller.estimation.process_model import ProcessModel
from idc_controller.estimation.propagation_kernels import about_reference, are_finite, defect, propagated_variances
from idc_controller.estimation.setpoint_history import SetpointHistory
from idc_controller.trajectory.flatness import Reference

_NONE = np.zeros(0)
_SAME = 1e-6
"""Times closer than this (s) are the same."""


class PropagationInterval:
    """Times from the last update to the time of the estimate, with reference and set-points at all of them."""

    def __init__(
        self,
        process: ProcessModel,
        start: float,
        moments: list[float],
        end: float,
        setpoints: SetpointHistory,
        reference: Reference,
    ) -> None:
        """``start``, ``moments`` of the measurements in between, and ``end`` (s)."""
        self._process = process
        times = sorted([start, *moments, end])
        for switch in setpoints.switches(start + _SAME, end - _SAME):
            after = bisect_left(times, switch)
            if switch - times[after - 1] > _SAME and times[after] - switch > _SAME:
                times.insert(after, switch)
        self.times = sorted(set(times))
        self.flat = reference.at(np.array(self.times))
        links, p = self.flat.links, process.model.parameters
        self.u, self.force_of_mass, self.nominal = about_reference(
            self.flat.x,
            self.flat.u,
            self.flat.payload,
            links.on_payload,
            links.on_uavs,
            p.g,
            reference.load.mass - p.m_0,
        )
        """The reference's set-points (K - 1, 3 N), and the force of one kilogram of excess of mass (K - 1, 3) (N/kg),
        from each time to the next; state of the exact reference at each time (K, n)."""
        steps = list(pairwise(self.times))
        self.setpoints = [setpoints.in_force(*step) for step in steps]
        """Set-points in force from each time to the next."""
        self.durations = [max(round((later - earlier) * 1e6), 1) for earlier, later in steps]
        """Durations from each time to the next (us)."""

    def input(self, k: int) -> Array:
        """Return the set-points in force less the reference's (3 N,) from time ``k`` to the next."""
        u = self.setpoints[k].u
        return np.zeros(self.u.shape[1]) if u is None else u - self.u[k]

    def nonlinear_part(self, k: int, error: Array) -> Array:
        """Return what the linear model leaves out (n,) of how an ``error`` (n,) changes from time ``k`` to the next.

        Of vehicles that are held it leaves out nothing: the ground holds the payload, of which no equation knows.
        """
        if self.setpoints[k].u is None:
            return np.zeros(len(error))
        return self._process.nonlinear_part(error, self.nominal[k], self.force_of_mass[k], self.durations[k])

    def defect(self, k: int) -> Array:
        """Return what the attitudes and thrusts of the reference lack to follow from its set-points (n,).

        From time ``k`` to the next. Their derivatives come from differences over the stencil: where a plan's snap has
        kinks, which is at every new plan, the reference is no solution of the attitude loop and of the motors. These
        are linear in themselves, so with the defect their states follow from the set-points alone.
        """
        transition, layout = self._process.transition(self.durations[k]), self._process.layout
        return defect(
            self.nominal[k], self.nominal[k + 1], self.u[k], *transition.sparse, transition.B,
            layout.n.start, layout.size,
        )  # fmt: skip


class ErrorStateFilter(StructuredKalmanFilter):
    """Kalman filter on the error about the exact reference of one propagation interval after the other."""

    def __init__(self, process: ProcessModel) -> None:
        super().__init__(dim_x=process.size, dim_z=1)
        self.process = process
        self._nominal = np.zeros((1, process.size))

    def start(self, x: Array, P: Array, interval: PropagationInterval) -> None:
        """Begin an ``interval`` from the absolute state ``x`` (n,) with covariance ``P`` (n, n)."""
        self._nominal = interval.nominal
        self.x, self.P = x - interval.nominal[0], P

    def state(self, k: int) -> Array:
        """Return the absolute state (n,) at time ``k`` of the interval."""
        return np.asarray(self.x + self._nominal[k])

    def advance(self, interval: PropagationInterval, k: int, force_scale: float) -> None:
        """Propagate from time ``k`` to the next under the set-points in force; ``force_scale``: of process noise."""
        nonlinear = interval.nonlinear_part(k, self.x)
        self.advance_linear(interval, k, force_scale)
        self.x = self.x + interval.defect(k) + nonlinear

    def advance_linear(self, interval: PropagationInterval, k: int, force_scale: float) -> None:
        """Propagate as :meth:`advance`, the covariance whole, the state by the linear model alone."""
        _, change, probability = interval.setpoints[k]
        duration = interval.durations[k]
        self.propagate(
            self.process.transition(duration), interval.force_of_mass[k], interval.input(k),
            self.process.noise(duration, force_scale), _NONE if change is None else change, probability,
        )  # fmt: skip

    def state_ahead(self, interval: PropagationInterval, k: int) -> Array:
        """Return the absolute state (n,) at the end of the interval from that at time ``k``, which remains."""
        x = self.x
        for later in range(k, len(interval.times) - 1):
            transition = self.process.transition(interval.durations[later])
            left_out = interval.defect(later) + interval.nonlinear_part(later, x)
            x = transition.state(x, interval.force_of_mass[later], interval.input(later)) + left_out
        return np.asarray(x + self._nominal[-1])

    @property
    def is_finite(self) -> bool:
        """Return whether state and covariance are numbers."""
        return are_finite(self.x, self.P)

    def restart(self, P: Array) -> None:
        """Begin anew from the reference with covariance ``P`` (n, n)."""
        self.x, self.P = np.zeros(self.process.size), P

    def move(self, change: Array, added: Array) -> None:
        """Add a ``change`` (n,) to the state and ``added`` (n, n) to its covariance."""
        self.x, self.P = self.x + change, self.P + added

    def inflate(self, added: Array) -> None:
        """Add ``added`` (n, n) to the covariance."""
        self.P = self.P + added

    def apply(self, innovation: Innovation, variance: Array, measured: Indices) -> float:
        """Correct by measurements and return their normalised innovation squared.

        Args:
            innovation: theirs.
            variance: of the measurements (m,).
            measured: UAVs whose position and velocity are among them.
        """
        squared = self.correct(innovation, variance)
        self.process.add_per_vehicle_noise(self.P, measured)
        return squared


class Outlook(NamedTuple):
    """Covariance at the end of an ``interval``, predicted only as far as it is asked for."""

    process: ProcessModel
    interval: PropagationInterval
    k: int
    """Index of the last time that was filtered."""
    P: Array
    """Covariance there (n, n)."""
    force_scale: float
    """Of process noise."""

    def force_covariance(self) -> Array:
        """Return the covariance (3, 3) of the force on the payload, which nothing but its own noise changes."""
        force = self.process.force
        covariance = self.P[force, force]
        for k in range(self.k, len(self.interval.times) - 1):
            covariance = covariance + self.process.noise(self.interval.durations[k], self.force_scale)[force, force]
        return covariance

    def covariance(self) -> Array:
        """Return the covariance (n, n) of the whole state."""
        return self._covariance(len(self.interval.times) - 1)

    def payload_variances(self) -> Array:
        """Return the variances (12,) of the payload's states, the diagonal of :meth:`covariance`, at less cost."""
        interval, last = self.interval, len(self.interval.times) - 2
        if last < self.k:
            return self.P.diagonal()[:12]
        duration, (_, change, probability) = interval.durations[last], interval.setpoints[last]
        transition = self.process.transition(duration)
        return propagated_variances(
            self._covariance(last), transition.dense[:12], transition.push, interval.force_of_mass[last], transition.B,
            self.process.noise(duration, self.force_scale), _NONE if change is None else change, probability,
        )  # fmt: skip

    def _covariance(self, end: int) -> Array:
        """Return the covariance (n, n) at time ``end`` of the interval."""
        if end <= self.k:
            return self.P
        filter = ErrorStateFilter(self.process)
        filter.start(self.interval.nominal[0], self.P, self.interval)
        for k in range(self.k, end):
            filter.advance_linear(self.interval, k, self.force_scale)
        return filter.P
