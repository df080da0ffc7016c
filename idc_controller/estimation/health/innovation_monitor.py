"""Monitoring of each sensor's innovations over time: biases far below the gate, noise, and repeated rejections.

Innovations of a consistent filter, normalised by their covariance, are independent and normal with variance 1. Running
means over about a second show what no single sample does. A fault of one channel, a pose or its motion, is diluted by
the other one: whole samples and each of their channels are tested.
"""

from collections import defaultdict, deque
from collections.abc import Sequence
from dataclasses import dataclass
from enum import Enum

import numpy as np

from idc_controller.arrays import Array, Indices, Mask
from idc_controller.estimation.health.chi_squared import lower_quantile, upper_quantile
from idc_controller.estimation.health.innovation_monitor_kernels import running_means
from idc_controller.estimation.measurements import PAYLOAD, Attitude, SensorKey
from idc_controller.estimation.settings import InnovationMonitorSettings


class Finding(Enum):
    """Fault of a sensor that its innovations show."""

    REJECTED = "rejected"
    BIASED = "biased"
    NOISY = "noisy"


@dataclass
class _Statistics:
    """Running means of S sensors; samples with another number of rows are of a sensor of their own."""

    mean: Array
    """Of the innovations, each channel in a half (S, 6)."""
    square: Array
    """Of the mean squares of all rows and of each channel (S, 3)."""
    last: Array
    """Times of the last samples (S,) (s)."""
    of_uav_attitude: Mask
    """Sensors (S,) whose limits are wider."""
    mean_limits: Array
    """(S, 3)"""
    square_limits: Array
    """(S, 3)"""

    def append(self, of_uav_attitude: bool, mean_limits: Array, square_limits: Array) -> None:
        """Append a sensor without samples."""
        self.mean, self.square = np.vstack([self.mean, np.zeros(6)]), np.vstack([self.square, np.ones(3)])
        self.last = np.append(self.last, -np.inf)
        self.of_uav_attitude = np.append(self.of_uav_attitude, of_uav_attitude)
        self.mean_limits = np.vstack([self.mean_limits, mean_limits])
        self.square_limits = np.vstack([self.square_limits, square_limits])


class InnovationMonitor:
    """Learns from the innovations of one moment after the other, and reports inconsistent sensors."""

    def __init__(
        self, gate_probability: float, settings: InnovationMonitorSettings = InnovationMonitorSettings()
    ) -> None:
        """``gate_probability`` of the innovation test: beyond it a sample counts as one at the gate."""
        self._settings = s = settings
        self._sensors: dict[tuple[SensorKey, int], int] = {}
        """Index of each sensor and number of rows: some samples have only one of its channels."""
        none = np.zeros((0, 3))
        self._statistics = _Statistics(np.zeros((0, 6)), none, np.zeros(0), np.zeros(0, dtype=bool), none, none)
        self._rejections: dict[tuple[SensorKey, int], deque[float]] = {}
        """Times of the rejections of late (s)."""
        sizes = np.arange(7)
        self._gates = lower_quantile(gate_probability, sizes)
        # Rows of a sample of each size, and of its two channels; of a single channel the first is the sample.
        rows = np.array([(n, n // 2, n // 2) if n > 3 else (n, n, 1) for n in np.maximum(sizes, 1)])
        kept = (2.0 - s.share) / s.share
        # Variance of a running mean is 1 / kept; its square sum times kept is chi-squared with as many degrees of
        # freedom as rows, and the running mean square like one of kept * rows of them.
        self._mean_limits = upper_quantile(s.false_alarm / 3.0, rows) / kept
        self._square_limits = upper_quantile(s.false_alarm / 3.0, kept * rows) / (kept * rows)

    def learn(
        self, time: float, keys: Sequence[SensorKey], sizes: Indices, normalised: Array, rejected: Sequence[SensorKey]
    ) -> None:
        """Learn from one moment; one that is replayed counts only for what is new in it.

        Args:
            time: s.
            keys: the sensors.
            sizes: rows of each (K,).
            normalised: their normalised innovations, one after the other (m,).
            rejected: those of them that the innovation test rejected.
        """
        sensors = list(zip(keys, sizes.tolist(), strict=True))
        which = np.array([self._index(sensor) for sensor in sensors])
        statistics = self._statistics
        new = running_means(
            time, which, sizes, normalised, self._gates, self._settings.share,
            statistics.mean, statistics.square, statistics.last,
        )  # fmt: skip
        for sensor, is_new in zip(sensors, new.tolist(), strict=True) if rejected else ():
            if is_new and sensor[0] in rejected:
                self._rejections.setdefault(sensor, deque()).append(time)

    def forget_attitudes(self) -> None:
        """Discard what was learnt of the UAVs' attitudes."""
        statistics = self._statistics
        attitudes = statistics.of_uav_attitude
        statistics.mean[attitudes], statistics.square[attitudes], statistics.last[attitudes] = 0.0, 1.0, -np.inf
        for entry in tuple(self._rejections):
            if _is_uav_attitude(entry[0]):
                del self._rejections[entry]

    def findings(self, time: float) -> dict[SensorKey, list[Finding]]:
        """Return what is wrong with sensors at ``time`` (s)."""
        s, statistics = self._settings, self._statistics
        squares = (statistics.mean.reshape(-1, 2, 3) ** 2).sum(axis=2)
        totals = np.column_stack([squares.sum(axis=1), squares])
        biased = np.asarray((totals > statistics.mean_limits).any(axis=1))
        noisy = np.asarray((statistics.square > statistics.square_limits).any(axis=1))
        for entry, times in tuple(self._rejections.items()):
            while times and time - times[0] > s.rejection_time:
                times.popleft()
            if not times:
                del self._rejections[entry]
        found: dict[SensorKey, list[Finding]] = defaultdict(list)
        if self._rejections or biased.any() or noisy.any():
            for entry, at in self._sensors.items():
                factor = s.manoeuvre_factor if statistics.of_uav_attitude[at] else 1.0
                if len(self._rejections.get(entry, ())) >= factor * s.rejections:
                    found[entry[0]].append(Finding.REJECTED)
                if biased[at]:
                    found[entry[0]].append(Finding.BIASED)
                if noisy[at]:
                    found[entry[0]].append(Finding.NOISY)
        return dict(found)

    def _index(self, sensor: tuple[SensorKey, int]) -> int:
        at = self._sensors.get(sensor)
        if at is None:
            key, size = sensor
            at = self._sensors[sensor] = len(self._sensors)
            wide = _is_uav_attitude(key)
            factor = self._settings.manoeuvre_factor if wide else 1.0
            self._statistics.append(wide, factor * self._mean_limits[size], factor * self._square_limits[size])
        return at


def _is_uav_attitude(key: SensorKey) -> bool:
    source, kind = key
    return source != PAYLOAD and kind is Attitude
