"""Isolation of vehicles' channels that the innovation test has rejected for long, until they are consistent again.

A single rejection may be the filter's error. But after a covariance reset (a gust, a load that changes) its gate is
wide, and a sensor that has been wrong all along would pass it, and outweigh all others.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from idc_controller.arrays import Mask
from idc_controller.estimation.health.chi_squared import lower_quantile
from idc_controller.estimation.kalman_filter import Innovation
from idc_controller.estimation.measurement_model import ObservationStack
from idc_controller.estimation.measurements import PAYLOAD, Channel, Position
from idc_controller.estimation.settings import ChannelIsolationSettings


class ChannelIsolation:
    """Isolated channels of N vehicles; never of more than half of the vehicles, which do not fail simultaneously."""

    def __init__(self, number_of_uavs: int, settings: ChannelIsolationSettings = ChannelIsolationSettings()) -> None:
        self._number_of_uavs, self._settings = number_of_uavs, settings
        self._gate = float(lower_quantile(self._settings.restoring_probability, 3))
        self._rejections: dict[Channel, int] = {}
        self._acceptances: dict[Channel, int] = {}

    def copy(self) -> ChannelIsolation:
        """Return one with the same counts, which counts on by itself."""
        other = ChannelIsolation.__new__(ChannelIsolation)  # a tenth of the time of copy.copy
        vars(other).update(vars(self))
        other._rejections, other._acceptances = self._rejections.copy(), self._acceptances.copy()
        return other

    @property
    def isolated(self) -> tuple[Channel, ...]:
        """The isolated channels."""
        return tuple(self._acceptances)

    @property
    def uavs_without_position(self) -> tuple[int, ...]:
        """UAVs of which both position and velocity are isolated."""
        if not self._acceptances:
            return ()
        return tuple(sorted(c.source for c in self._acceptances if c.kind is Position and not c.part
                            and c._replace(part=1) in self._acceptances))  # fmt: skip

    def rows(self, stack: ObservationStack) -> Mask:
        """Return the rows (m,) of a whole ``stack`` that belong to isolated channels."""
        rows = np.zeros(len(stack.variance), dtype=bool)
        for channel, part in _channels(stack):
            rows[part] = channel in self._acceptances
        return rows

    def learn(
        self,
        stack: ObservationStack,
        tested: Mask,
        accepted: Mask,
        is_inconsistent: Callable[[int], bool],
    ) -> None:
        """Count the rejections of one moment, and isolate what has too many.

        Args:
            stack: all measurements of the moment.
            tested: its rows (m,) that took the innovation test.
            accepted: those of them that passed.
            is_inconsistent: whether position and velocity of a UAV contradict each other. Where they do not, and yet
                are rejected, it is the vehicle that does not fly as it should: its own attitude estimate may be wrong.
        """
        if not self._rejections and np.count_nonzero(accepted) == np.count_nonzero(tested):
            return
        limit = self._settings.rejections
        for channel, part in _channels(stack):
            if channel in self._acceptances or not tested[part].all():
                continue
            count = self._rejections.pop(channel, 0) + (-1 if accepted[part].all() else 1)
            is_wrong = channel.kind is not Position or is_inconsistent(channel.source)
            if count >= limit and is_wrong and self._is_no_majority_with(channel.source):
                for wrong in self._suspected(channel):
                    self._acceptances.setdefault(wrong, 0)
                    self._rejections.pop(wrong, None)
            elif count > 0:
                self._rejections[channel] = min(count, limit)

    def restore(self, stack: ObservationStack, innovation: Innovation, noise_scale: float) -> None:
        """Restore isolated channels that have been consistent with the prediction for long.

        Args:
            stack: all measurements of the moment.
            innovation: theirs.
            noise_scale: scale of the measurement variances.
        """
        for channel, part in _channels(stack):
            residual = innovation.residual[part]
            if channel not in self._acceptances or not np.isfinite(residual).all():
                continue
            covariance = innovation.covariance[part, part] + noise_scale * np.diag(stack.variance[part])
            squared = float(residual @ np.linalg.solve(covariance, residual))
            self._acceptances[channel] = self._acceptances[channel] + 1 if squared <= self._gate else 0
            if self._acceptances[channel] >= self._settings.acceptances:
                del self._acceptances[channel]

    def _suspected(self, rejected: Channel) -> tuple[Channel, ...]:
        """Return the channels of which one must be wrong if this one is rejected.

        Of a position and a velocity that contradict each other the state may have followed the wrong one, so that the
        right one is rejected. That one is restored when it is consistent with the other sources. As long as it takes,
        the state of the vehicle is predicted only: of no more than one vehicle at a time.
        """
        if rejected.kind is not Position or any(uav != rejected.source for uav in self.uavs_without_position):
            return (rejected,)
        return tuple(rejected._replace(part=part) for part in (0, 1))

    def _is_no_majority_with(self, source: int) -> bool:
        return 2 * len({channel.source for channel in self._acceptances} | {source}) <= self._number_of_uavs


def _channels(stack: ObservationStack) -> list[tuple[Channel, slice]]:
    """Return the vehicles' channels in a whole stack, with their rows."""
    return [
        (Channel(source, kind, part), slice(start + part * size // 2, start + (part + 1) * size // 2))
        for (source, kind), start, size in zip(stack.keys, stack.starts.tolist(), stack.sizes.tolist(), strict=True)
        if source != PAYLOAD
        for part in (0, 1)
    ]
