"""Stuck sensors: repeated values of a channel with noise."""

import numpy as np
import pytest

from idc_controller.estimation.health.sensor_health import StuckSensors
from idc_controller.estimation.measurements import PAYLOAD, Attitude, MeasurementNoise, Position

NOISE = MeasurementNoise()
UNIT = np.array([1.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("source", [PAYLOAD, 2])
@pytest.mark.parametrize("part", [0, 1])
@pytest.mark.parametrize("kind", [Position, Attitude])
def test_only_the_stuck_channel_is_detected(source, part, kind):
    random, sensors = np.random.default_rng(1), StuckSensors(NOISE)

    def sample(k):
        parts = [random.standard_normal(4 if kind is Attitude else 3), random.standard_normal(3)]
        if k >= 5:
            parts[part] = np.ones(len(parts[part]))
        return kind(0.04 * k, source, *parts)

    found = [check(sensors, sample(k)) for k in range(12)]
    assert [stuck[part] for stuck in found] == [False] * 7 + [True] * 5
    assert not any(stuck[1 - part] for stuck in found)
    assert not any(check(sensors, kind(1.0, source, random.standard_normal(4 if kind is Attitude else 3), np.zeros(3))))


def check(sensors, sample):
    return sensors.check(sample, sample.pose.tolist(), sample.motion.tolist())


def test_relayed_and_late_copies_do_not_count_as_repeats():
    sensors = StuckSensors(NOISE)
    for k in range(5):
        for time in (0.04 * k, 0.04 * k, 0.04 * k, 0.04 * max(k - 1, 0)):
            assert not any(check(sensors, Position(time, PAYLOAD, np.full(3, time), np.full(3, 2.0 + time))))


def test_repeated_value_is_not_stuck_without_noise():
    sensors = StuckSensors(MeasurementNoise(position=0.0, uav_velocity=0.0))
    assert not any(any(check(sensors, Position(0.04 * k, 1, np.zeros(3), np.zeros(3)))) for k in range(9))
