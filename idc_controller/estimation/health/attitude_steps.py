"""Steps of a UAV's attitude that its body rates do not explain.

No vehicle turns by several degrees between two samples without a rate: such a step is an error of the attitude. If the
error is on board, the vehicle turns against it at once, by its own attitude loop; from then on its thrust is off its
attitude by the step. If it is an error of the telemetry alone, nothing turns.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from scipy.linalg import expm
from scipy.stats import chi2

from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, MeasurementNoise
from idc_controller.estimation.settings import AttitudeStepSettings
from idc_controller.parameters import SystemParameters


class AttitudeStep(NamedTuple):
    """A step of the attitude of one UAV (0 .. N-1), which it flies by."""

    uav: int
    time: float
    """Of the first attitude after it (s)."""
    interval: float
    """Since the last one before it (s)."""
    angle: Array
    """Change of the reported thrust direction n (2,) (rad)."""
    deviation: float
    """Standard deviation of it, on each axis (rad)."""


class _Sample(NamedTuple):
    time: float
    n: Array
    n_dot: Array


class _Candidate(NamedTuple):
    step: AttitudeStep
    before: _Sample
    since: Array
    """What the attitude has turned without rates since then (2,) (rad)."""
    latest: _Sample | None
    """The newest sample after the step; None: it was the newest."""


def step_response(parameters: SystemParameters, time: float) -> Array:
    """Return turn (rad), rate (1/s) and acceleration (1/s2) of a UAV at ``time`` (s) after its attitude stepped by one.

    It is that of the attitude loop of :mod:`idc_controller.model.linear`.
    """
    p = parameters
    A = np.zeros((4, 4))
    A[0, 1] = A[1, 2] = 1.0
    A[2] = -np.array([p.attitude_kp, p.attitude_kd, 1.0, p.attitude_kp]) / p.motor_time_constant
    return np.asarray((expm(time * A) @ [0.0, 0.0, 0.0, 1.0])[:3])


def _time_of_largest_rate(parameters: SystemParameters) -> float:
    """Return the time (s) after a step of the attitude at which the vehicle turns fastest against it."""
    times = np.linspace(0.0, 5.0 / parameters.attitude_kp**0.5, 101)
    return float(times[np.argmin([step_response(parameters, time)[1] for time in times])])


class AttitudeSteps:
    """Compares the attitudes of N UAVs with their body rates, from sample to sample."""

    def __init__(self, parameters: SystemParameters, noise: MeasurementNoise, settings: AttitudeStepSettings) -> None:
        """``noise`` of the sensors."""
        self._parameters, self._settings = parameters, settings
        self._quantile = float(np.sqrt(chi2.isf(settings.false_alarm, 2)))
        self._nominal = 2.0 * noise.attitude**2
        self._variances = np.full(parameters.number_of_uavs, self._nominal)
        """Of the differences of two attitudes, as they are at present (N,)."""
        self._response_time = _time_of_largest_rate(parameters)
        """Since a step (s): until then the rate of the turn against it rises."""
        self._last: dict[int, _Sample] = {}
        self._stuck: set[int] = set()
        """UAVs whose attitude has repeated itself although they turned: how far is not known."""
        self._candidates: dict[int, _Candidate] = {}
        self.total = np.zeros((parameters.number_of_uavs, 2))
        """Sum of all steps of each UAV (N, 2) (rad), those in telemetry alone, too."""
        self.drift = np.zeros((parameters.number_of_uavs, 2))
        """What each UAV's attitude has turned lately without rates (N, 2) (rad)."""

    def add(self, measurement: Measurement) -> None:
        """Take a measurement; only attitudes of UAVs with their rates are used."""
        uav = measurement.source
        if uav == PAYLOAD or not isinstance(measurement, Attitude):
            return
        last, sample = self._last.get(uav), _sample(measurement)
        if last is not None and measurement.time <= last.time:
            return
        if not np.isfinite(sample.n @ sample.n + sample.n_dot @ sample.n_dot):
            return
        self._last[uav] = sample
        candidate = self._candidates.pop(uav, None)
        if last is None or sample.time - last.time > self._settings.gap:
            return
        if np.array_equal(sample.n, last.n):
            if sample.n_dot.any():
                self._stuck.add(uav)
            return
        if uav in self._stuck:
            self._stuck.remove(uav)
            return
        interval = sample.time - last.time
        jump = sample.n - last.n - 0.5 * interval * (sample.n_dot + last.n_dot)
        self.drift[uav] += jump - interval / self._settings.drift_memory * self.drift[uav]
        stepped = self._is_step(uav, jump, interval)
        if candidate is not None:
            self._follow(candidate, sample, jump, stepped)
        elif stepped:
            step = AttitudeStep(uav, sample.time, interval, jump, float(np.sqrt(self._variances[uav])))
            self._candidates[uav] = _Candidate(step, last, jump, None)

    def _follow(self, candidate: _Candidate, sample: _Sample, jump: Array, stepped: bool) -> None:
        """Keep a ``candidate`` with the next ``sample``, unless that takes it back or comes late.

        What the first sample after it does not take back is none of an outlier, and counts in the sum.
        """
        step, s = candidate.step, self._settings
        since = candidate.since + jump
        persists = float(since @ step.angle) > s.persistent_share * float(step.angle @ step.angle)
        counted = candidate.latest is not None
        if persists is not counted:
            self.total[step.uav] += step.angle if persists else -step.angle
        if persists and not stepped and sample.time - step.time < self._response_time:
            self._candidates[step.uav] = candidate._replace(since=since, latest=sample)

    def _is_step(self, uav: int, jump: Array, interval: float) -> bool:
        """Return whether a ``jump`` (2,) after an ``interval`` (s) is none of the noise, which is followed."""
        s, square = self._settings, float(jump @ jump)
        limit = self._quantile * float(np.sqrt(self._variances[uav])) + s.turn_error * interval
        share = min(interval / s.noise_memory, 1.0)
        variance = self._variances[uav] + share * (min(0.5 * square, limit**2) - self._variances[uav])
        self._variances[uav] = max(variance, self._nominal)
        return square > limit**2

    def confirmed(self, explained: Callable[[int, float, float], Array]) -> list[AttitudeStep]:
        """Return new steps of vehicles that turn against them as their attitude loops do.

        ``explained``: change of n' (2,) (1/s) of a UAV between two times (s) that follows from its set-points.
        """
        found = [
            candidate.step
            for candidate in self._candidates.values()
            if candidate.latest is not None and self._is_confirmed(candidate, candidate.latest, explained)
        ]
        for step in found:
            del self._candidates[step.uav]
        return found

    def _is_confirmed(
        self, candidate: _Candidate, latest: _Sample, explained: Callable[[int, float, float], Array]
    ) -> bool:
        step, before, s = candidate.step, candidate.before, self._settings
        change = latest.n_dot - before.n_dot - explained(step.uav, before.time, latest.time)
        turned = -float(change @ step.angle) / float(step.angle @ step.angle)
        elapsed = latest.time - step.time
        latest_end = min(elapsed + step.interval, self._response_time)
        first, last = (-step_response(self._parameters, t)[1] for t in (elapsed, latest_end))
        return bool(s.response_min * first < turned < s.response_max * last)


def _sample(measurement: Attitude) -> _Sample:
    """Return the thrust direction n = -R e3 and n' = -R (omega x e3), level parts (2,)."""
    w, a, b, c = measurement.pose.tolist()
    p, q, _ = measurement.motion.tolist()
    n = np.array([-2.0 * (a * c + w * b), -2.0 * (b * c - w * a)])
    n_dot = np.array([
        2.0 * (a * b - w * c) * p - (1.0 - 2.0 * (b * b + c * c)) * q,
        (1.0 - 2.0 * (a * a + c * c)) * p - 2.0 * (a * b + w * c) * q,
    ])  # fmt: skip
    return _Sample(measurement.time, n, n_dot)
