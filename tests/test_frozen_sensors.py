"""A value that is told again and again is no measurement; without noise it may be one."""

import numpy as np
import pytest

from idc_controller.estimation.health.stuck_sensor import FrozenSensors
from idc_controller.estimation.measurements import PAYLOAD, Attitude, MeasurementNoise, Position

NOISE = MeasurementNoise()
UNIT = np.array([1.0, 0.0, 0.0, 0.0])


@pytest.mark.parametrize("source", [PAYLOAD, 2])
@pytest.mark.parametrize("part", [0, 1])
@pytest.mark.parametrize("kind", [Position, Attitude])
def test_the_part_that_is_frozen_is_found(source, part, kind):
    random, sensors = np.random.default_rng(1), FrozenSensors(NOISE)

    def sample(k):
        parts = [random.standard_normal(4 if kind is Attitude else 3), random.standard_normal(3)]
        if k >= 5:
            parts[part] = np.ones(len(parts[part]))
        return kind(0.04 * k, source, *parts)

    told = [sensors.frozen(sample(k)) for k in range(12)]
    assert [frozen[part] for frozen in told] == [False] * 7 + [True] * 5
    assert not any(frozen[1 - part] for frozen in told)
    assert not any(sensors.frozen(kind(1.0, source, random.standard_normal(4 if kind is Attitude else 3), np.zeros(3))))


def test_relays_and_late_copies_of_one_sample_are_no_repeats():
    sensors = FrozenSensors(NOISE)
    for k in range(5):
        for time in (0.04 * k, 0.04 * k, 0.04 * k, 0.04 * max(k - 1, 0)):
            assert not any(sensors.frozen(Position(time, PAYLOAD, np.full(3, time), np.full(3, 2.0 + time))))


def test_without_noise_the_same_may_be_told_again():
    sensors = FrozenSensors(MeasurementNoise(position=0.0, uav_velocity=0.0))
    assert not any(any(sensors.frozen(Position(0.04 * k, 1, np.zeros(3), np.zeros(3)))) for k in range(9))
