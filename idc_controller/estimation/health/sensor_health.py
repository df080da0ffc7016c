"""Sensor health: which parts of a measurement the estimator may use."""

import math
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Mask
from idc_controller.estimation.health.channel_isolation import ChannelIsolation
from idc_controller.estimation.health.dead_reckoning import DeadReckoning
from idc_controller.estimation.health.noise_adaptation import NoiseAdaptation
from idc_controller.estimation.health.stuck_sensor import StuckSensors
from idc_controller.estimation.kalman_filter import Innovation
from idc_controller.estimation.measurement_model import ObservationStack
from idc_controller.estimation.measurements import (
    PAYLOAD,
    Channel,
    Measurement,
    MeasurementNoise,
    Position,
    SensorGroup,
    SensorKey,
)
from idc_controller.estimation.settings import EstimatorSettings


class HealthSnapshot(NamedTuple):
    """Parts that learn anew when measurements are replayed."""

    adaptation: NoiseAdaptation
    isolation: ChannelIsolation


class SensorHealth:
    """Stuck sensors, inconsistent groups and isolated channels of N UAVs and of the payload unit."""

    def __init__(self, number_of_uavs: int, noise: MeasurementNoise, settings: EstimatorSettings) -> None:
        self.number_of_uavs, self._settings = number_of_uavs, settings
        self._stuck = StuckSensors(noise, settings.stuck_sensor)
        self.dead_reckoning = DeadReckoning(number_of_uavs, settings.dead_reckoning)
        self.isolated_groups: dict[SensorGroup, tuple[bool, bool]] = {}
        """Inconsistent groups, and isolation of their poses and of their motions: the worse explained ones."""
        self.adaptation: NoiseAdaptation
        self.isolation: ChannelIsolation
        self._unusable_since: dict[SensorKey, float] = {}
        self.start()

    def start(self) -> None:
        """Discard what was learnt from innovations."""
        self.adaptation = NoiseAdaptation(self._settings.reset.payload_rejections, self._settings.adaptation)
        self.isolation = ChannelIsolation(self.number_of_uavs, self._settings.isolation)

    def snapshot(self) -> HealthSnapshot:
        """Return a copy of what is learnt from innovations."""
        return HealthSnapshot(self.adaptation.copy(), self.isolation.copy())

    def restore(self, snapshot: HealthSnapshot) -> None:
        """Take the state of a snapshot."""
        self.adaptation, self.isolation = snapshot.adaptation.copy(), snapshot.isolation.copy()

    @property
    def uav_positions_isolated(self) -> bool:
        """Return whether the positions of all UAVs are isolated, as they contradict their velocities."""
        return self.isolated_groups.get(SensorGroup(False, Position), (False, False))[0]

    @property
    def stuck_channels(self) -> list[Channel]:
        """Channels that repeat the same value."""
        return self._stuck.channels()

    def unusable_poses(self, kind: type[Measurement], time: float) -> frozenset[int]:
        """Return the UAVs whose pose of this ``kind`` was missing, stuck or rejected shortly before ``time`` (s).

        Of positions a rejection of the velocity counts as well: poses between two samples are extrapolated by it.
        """
        if SensorGroup(False, kind) in self.isolated_groups:
            return frozenset(range(self.number_of_uavs))
        return frozenset(
            source
            for (source, of), since in self._unusable_since.items()
            if of is kind and source != PAYLOAD and time - since < self._settings.isolation.unusable_time
        )

    def received(self, measurement: Measurement) -> Measurement | None:
        """Return what has arrived without channels that are stuck or not finite; None if nothing is left."""
        pose, motion = measurement.pose.tolist(), measurement.motion.tolist()
        if math.isfinite(sum(pose) + sum(motion)):
            usable, stuck = measurement, self._stuck.check(measurement, pose, motion)
        else:
            usable = measurement.finite
            stuck = self._stuck.check(usable, usable.pose.tolist(), usable.motion.tolist())
        if True in stuck:
            usable = usable.without(*stuck)
        if usable is measurement:  # with pose and motion
            return usable
        if not usable.has_pose:
            self._unusable_since[usable.source, type(usable)] = usable.time
        return usable if usable.has_pose or usable.has_motion else None

    def usable(self, measurement: Measurement) -> Measurement:
        """Return a measurement without the channels of isolated groups."""
        isolated = self.isolated_groups.get(SensorGroup(measurement.source == PAYLOAD, type(measurement)))
        return measurement if isolated is None else measurement.without(*isolated)

    def usable_rows(self, stack: ObservationStack, innovation: Innovation) -> Mask:
        """Return which rows (m,) of one moment may be used; isolated channels that are consistent are restored.

        Args:
            stack: all measurements of the moment.
            innovation: theirs, nan where nothing was measured.
        """
        present = np.isfinite(innovation.residual)
        if self.isolation.isolated:
            self.isolation.restore(stack, innovation, self.adaptation.measurement_scale)
            present &= ~self.isolation.rows(stack)
        return present

    def rejected(self, time: float, keys: list[SensorKey]) -> None:
        """Note at ``time`` (s) that the poses of these sensors, and of all isolated channels, are unusable."""
        for key in keys:
            self._unusable_since[key] = time
        for channel in self.isolation.isolated:
            if channel.kind is Position or not channel.part:
                self._unusable_since[channel.source, channel.kind] = time
