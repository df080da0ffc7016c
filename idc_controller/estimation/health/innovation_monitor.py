"""Monitoring of each sensor's innovations over time: biases far below the gate, noise, and repeated rejections.

Innovations of a consistent filter, normalised by their covariance, are independent and normal with variance 1. Running
means over about a second show what no single sample does.
"""

from collections import defaultdict, deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from idc_controller.arrays import Array
from idc_controller.estimation.health.chi_squared import lower_quantile, upper_quantile
from idc_controller.estimation.measurements import PAYLOAD, Attitude, SensorKey
from idc_controller.estimation.settings import InnovationMonitorSettings


class Finding(Enum):
    """Fault of a sensor that its innovations show."""

    REJECTED = "rejected"
    BIASED = "biased"
    NOISY = "noisy"


@dataclass
class _Statistics:
    size: int
    mean: Array
    square: float = 1.0
    time: float = -np.inf
    rejections: deque[float] = field(default_factory=deque)


class InnovationMonitor:
    """Learns from the innovations of one moment after the other, and reports inconsistent sensors."""

    def __init__(
        self, gate_probability: float, settings: InnovationMonitorSettings = InnovationMonitorSettings()
    ) -> None:
        """``gate_probability`` of the innovation test: beyond it a sample counts as one at the gate."""
        self._settings = s = settings
        self._statistics: dict[tuple[SensorKey, int], _Statistics] = {}
        """Statistics by sensor and number of rows: some samples have only one of its channels."""
        sizes = np.arange(1, 7)
        kept = (2.0 - s.share) / s.share
        # Variance of a running mean is 1 / kept; its square sum times kept is chi-squared with ``size`` degrees of
        # freedom, and the running mean square like one of kept * size of them.
        self._gates = dict(zip(sizes.tolist(), lower_quantile(gate_probability, sizes).tolist(), strict=True))
        self._mean_limits = dict(
            zip(sizes.tolist(), (upper_quantile(s.false_alarm, sizes) / kept).tolist(), strict=True)
        )
        freedom = kept * sizes
        squares = upper_quantile(s.false_alarm, freedom) / freedom
        self._square_limits = dict(zip(sizes.tolist(), squares.tolist(), strict=True))

    def learn(
        self, time: float, keys: Sequence[SensorKey], normalised: Sequence[Array], rejected: Sequence[SensorKey]
    ) -> None:
        """Learn from one moment; one that is replayed counts only for what is new in it.

        Args:
            time: s.
            keys: the sensors.
            normalised: their normalised innovations.
            rejected: those of them that the innovation test rejected.
        """
        share = self._settings.share
        for key, innovation in zip(keys, normalised, strict=True):
            size = len(innovation)
            statistics = self._statistics.get((key, size))
            if statistics is None:
                statistics = self._statistics[key, size] = _Statistics(size, np.zeros(size))
            if time <= statistics.time:
                continue
            statistics.time = time
            gate = self._gates[size]
            bounded = np.nan_to_num(np.clip(innovation, -np.sqrt(gate), np.sqrt(gate)))
            statistics.mean = statistics.mean + share * (bounded - statistics.mean)
            square = min(float(bounded @ bounded), gate) / size
            statistics.square += share * (square - statistics.square)
            if key in rejected:
                statistics.rejections.append(time)

    def forget_attitudes(self) -> None:
        """Discard what was learnt of the UAVs' attitudes."""
        for entry in tuple(self._statistics):
            (source, kind), _ = entry
            if source != PAYLOAD and kind is Attitude:
                del self._statistics[entry]

    def findings(self, time: float) -> dict[SensorKey, list[Finding]]:
        """Return what is wrong with sensors at ``time`` (s)."""
        s = self._settings
        found: dict[SensorKey, list[Finding]] = defaultdict(list)
        for (key, _), statistics in self._statistics.items():
            while statistics.rejections and time - statistics.rejections[0] > s.rejection_time:
                statistics.rejections.popleft()
            factor = s.manoeuvre_factor if key[0] != PAYLOAD and key[1] is Attitude else 1.0
            if len(statistics.rejections) >= factor * s.rejections:
                found[key].append(Finding.REJECTED)
            if float(statistics.mean @ statistics.mean) > factor * self._mean_limits[statistics.size]:
                found[key].append(Finding.BIASED)
            if statistics.square > factor * self._square_limits[statistics.size]:
                found[key].append(Finding.NOISY)
        return dict(found)
