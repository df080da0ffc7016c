"""Sensors that tell the same again and again: what is measured with noise never does."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, MeasurementNoise, Position

Array = NDArray[np.float64]

RELAYED_WITHIN = 0.02
"""Stamps of one sample of the payload unit that several vehicles relay may differ by this (s)."""
REPEATS = 2
"""Repeated so often, a value is no measurement any more."""
PARTS: dict[type, tuple[str, str]] = {Attitude: ("attitude", "rates"), Position: ("position", "velocity")}


@dataclass
class _Last:
    time: float
    parts: tuple[Array, Array]
    repeats: list[int]


class FrozenSensors:
    """Watches every channel that is known to have noise."""

    def __init__(self, noise: MeasurementNoise) -> None:
        self._noise = noise
        self._last: dict[tuple[int, type], _Last] = {}

    def frozen(self, measurement: Measurement) -> tuple[bool, bool]:
        """Whether its pose, and whether its motion, is what its source has told several times before, to the digit."""
        key = measurement.source, type(measurement)
        if isinstance(measurement, Attitude):
            parts = measurement.quaternion, measurement.rates
        else:
            parts = measurement.position, measurement.velocity
        last = self._last.get(key)
        if last is None:
            self._last[key] = _Last(measurement.time, parts, [0, 0])
            return False, False
        if measurement.time > last.time + (RELAYED_WITHIN if measurement.source == PAYLOAD else 0.0):
            for k, (now, before) in enumerate(zip(parts, last.parts, strict=True)):
                last.repeats[k] = last.repeats[k] + 1 if bool((now == before).all()) else 0
            last.time, last.parts = measurement.time, parts
        return self._frozen_parts(key, last)

    def channels(self) -> list[tuple[int, str]]:
        """Those that are frozen now: source, and ``position``, ``velocity``, ``attitude`` or ``rates``."""
        return [
            (source, name)
            for (source, kind), last in self._last.items()
            for name, frozen in zip(PARTS[kind], self._frozen_parts((source, kind), last), strict=True)
            if frozen
        ]

    def _frozen_parts(self, key: tuple[int, type], last: _Last) -> tuple[bool, bool]:
        of_pose, of_motion = self._sigmas(*key)
        pose, motion = last.repeats
        return pose >= REPEATS and of_pose > 0.0, motion >= REPEATS and of_motion > 0.0

    def _sigmas(self, source: int, kind: type) -> tuple[float, float]:
        noise, of_payload = self._noise, source == PAYLOAD
        if kind is Attitude:
            return noise.attitude, noise.payload_rates if of_payload else noise.uav_rates
        return noise.position, noise.payload_velocity if of_payload else noise.uav_velocity
