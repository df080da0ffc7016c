"""Sensor health: which parts of a measurement the estimator may use."""

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idc_controller.arrays import Mask
from idc_controller.estimation.health.channel_isolation import ChannelIsolation
from idc_controller.estimation.health.dead_reckoning_kernels import reckon
from idc_controller.estimation.health.noise_adaptation import NoiseAdaptation
from idc_controller.estimation.kalman_filter import Innovation
from idc_controller.estimation.measurement_model import ObservationStack
from idc_controller.estimation.measurements import (
    PAYLOAD,
    Attitude,
    Channel,
    Measurement,
    MeasurementNoise,
    Position,
    SampleStack,
    SensorGroup,
    SensorKey,
)
from idc_controller.estimation.settings import DeadReckoningSettings, EstimatorSettings, StuckSensorSettings


class DeadReckoning:
    """Compares poses and motions of N UAVs and of the payload unit.

    The innovation test goes by what most sources measure. Positions that are wrong for one common reason (a base
    station that drifts, say) agree with each other and would bias the estimate. So would the payload's only unit, which
    is right when it persists after a blow. Yet each of them contradicts its own motion, whatever the others measure.

    Arrays are those of :func:`~idc_controller.estimation.health.dead_reckoning_kernels.reckon`.
    """

    def __init__(self, number_of_uavs: int, settings: DeadReckoningSettings = DeadReckoningSettings()) -> None:
        self._number_of_uavs, self._settings = number_of_uavs, settings
        sources = number_of_uavs + 2
        self._recent = np.zeros((sources, settings.smoothed, 8))
        self._motion, self._integral = np.zeros((sources, 3)), np.zeros((sources, 4))
        self._differences = np.zeros((sources, 256, 4))
        self._counts = np.zeros((sources, 5), dtype=int)
        self._ratio = np.full(sources, np.nan)
        self.inconsistent_groups: tuple[SensorGroup, ...] = ()
        """Groups whose poses contradict their motions.

        Most vehicles' positions, while the payload unit's are consistent; or the other way round; or the payload
        unit's attitude.
        """

    def add(self, samples: SampleStack) -> None:
        """Take the poses of one moment with their motions."""
        s = self._settings
        longest, tests = reckon(
            *samples, self._number_of_uavs, s.window, s.gap, s.samples, s.position_error, s.attitude_error, s.sigmas,
            self._recent, self._motion, self._integral, self._differences, self._counts, self._ratio,
        )  # fmt: skip
        if 2 * longest >= self._differences.shape[1]:
            self._differences = np.concatenate([self._differences, np.zeros_like(self._differences)], axis=1)
        if tests:
            self.inconsistent_groups = self._inconsistent()

    def is_inconsistent(self, uav: int) -> bool:
        """Return whether the position of a UAV contradicts its velocity."""
        return bool(self._ratio[uav] > 1.0)

    def _inconsistent(self) -> tuple[SensorGroup, ...]:
        *ratios, position, _ = self._ratio.tolist()  # nan where nothing was measured
        position_failed, attitude_failed = (self._counts[-2:, 4] >= self._settings.consecutive).tolist()
        consistent, most = self._settings.consistent_ratio, self._number_of_uavs
        found = []
        if position <= consistent and 2 * sum(r > 1.0 for r in ratios) > most:
            found.append(SensorGroup(False, Position))
        if position_failed and 2 * sum(r <= consistent for r in ratios) > most:
            found.append(SensorGroup(True, Position))
        if attitude_failed:
            found.append(SensorGroup(True, Attitude))
        return tuple(found)


@dataclass(slots=True)
class _Last:
    time: float
    pose: list[float]
    motion: list[float]
    repeats: tuple[int, int] = (0, 0)
    """Of the pose and of the motion."""
    stuck: tuple[bool, bool] = (False, False)
    """Whether the pose, and whether the motion, is stuck."""


class StuckSensors:
    """Counts repeated values of every channel that has noise."""

    def __init__(self, noise: MeasurementNoise, settings: StuckSensorSettings = StuckSensorSettings()) -> None:
        self._noise, self._settings = noise, settings
        self._last: dict[SensorKey, _Last] = {}

    def check(self, measurement: Measurement, pose: list[float], motion: list[float]) -> tuple[bool, bool]:
        """Take a measurement, by its numbers, and return whether its pose, and whether its motion, is stuck."""
        time, key = measurement.time, (measurement.source, type(measurement))
        last = self._last.get(key)
        if last is None:
            self._last[key] = _Last(time, pose, motion)
            return False, False
        if time <= last.time + (self._settings.relay_interval if measurement.source == PAYLOAD else 0.0):
            return last.stuck
        same_pose, same_motion = pose == last.pose, motion == last.motion
        if same_pose or same_motion:
            of_pose, of_motion = last.repeats
            last.repeats = of_pose + 1 if same_pose else 0, of_motion + 1 if same_motion else 0
            last.stuck = self._stuck_parts(key, last.repeats)
        else:
            last.repeats, last.stuck = (0, 0), (False, False)
        last.time, last.pose, last.motion = time, pose, motion
        return last.stuck

    def channels(self) -> list[Channel]:
        """Return the channels that are stuck now."""
        return [
            Channel(source, kind, part)
            for (source, kind), last in self._last.items()
            if True in last.stuck
            for part, stuck in enumerate(last.stuck)
            if stuck
        ]

    def _stuck_parts(self, key: SensorKey, repeats: tuple[int, int]) -> tuple[bool, bool]:
        limit, (pose, motion), (pose_sigma, motion_sigma) = self._settings.repeats, repeats, self._sigmas(*key)
        return pose >= limit and pose_sigma > 0.0, motion >= limit and motion_sigma > 0.0

    def _sigmas(self, source: int, kind: type) -> tuple[float, float]:
        noise, of_payload = self._noise, source == PAYLOAD
        if kind is Attitude:
            return noise.attitude, noise.payload_rates if of_payload else noise.uav_rates
        return noise.position, noise.payload_velocity if of_payload else noise.uav_velocity


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
