"""Effects of the sensors' faults on samples."""

import math

import numpy as np
import pytest
from fault_injection import STILL, TAKE_OFF, at, fault, injected

from vehicle_sim.world.range_sensor import RangeSample


def test_lost_sensors_are_missing_from_telemetry_or_on_board():
    without_position = injected(fault("position_lost", 1.0))
    first = without_position.own_sample(1, at(1.0))
    moved = without_position.own_sample(1, at(2.0)._replace(position=(9.0, 9.0, 9.0), rates=(1.0, 1.0, 1.0)))
    assert (moved.position, moved.velocity, moved.rates) == (first.position, first.velocity, (1.0, 1.0, 1.0))
    assert without_position.reported_sample(1, moved) == (moved, None)
    assert injected(fault("position_lost", onboard=False)).own_sample(1, at(1.0)) == at(1.0)

    assert injected(fault("attitude_lost")).reported_sample(1, at(1.0)) == (None, at(1.0))
    assert injected(fault("attitude_lost")).own_sample(1, at(1.0)) == at(1.0)
    dizzy = injected(fault("attitude_lost", onboard=True))
    dizzy.own_sample(1, at(1.0))
    assert dizzy.own_sample(1, at(2.0)._replace(attitude=(0.0, 1.0, 0.0, 0.0))).attitude == STILL.attitude

    rates = injected(fault("rates_lost")).reported_sample(1, at(1.0))
    assert all(math.isnan(w) for w in rates.attitude.rates) and rates.position == at(1.0)

    lost = injected(fault("payload_unit_lost", vehicles=(2,)))
    assert lost.payload_sample(2, at(1.0)) is None and lost.payload_sample(1, at(1.0)) == at(1.0)
    scan = RangeSample(TAKE_OFF + 1.0, 9.0, np.ones((1, 3)))
    dark = injected(fault("obstacle_sensing_lost", vehicles=(2,)))
    failed = dark.range_sample(2, scan)
    assert failed.points.shape == (0, 3) and not failed.works
    assert (failed.time, failed.reach, failed.range_min) == (scan.time, scan.reach, scan.range_min)
    assert dark.range_sample(1, scan) is scan
    silent = injected(fault("obstacle_sensing_lost", reported=False)).range_sample(2, scan)
    assert silent.works and not silent.is_sent and not failed.is_sent


def test_position_glitches_and_drifts():
    glitch = injected(fault("position_glitch", size=3.0, rate=0.5, hold=0.2))
    reported = np.array([glitch.own_sample(1, at(i * 0.01)).position for i in range(20_000)]) - STILL.position
    away = np.hypot(reported[:, 0], reported[:, 1]) > 0.0
    assert np.hypot(*reported[away, :2].T) == pytest.approx(np.full(away.sum(), 3.0))
    assert not np.any(reported[:, 2])
    assert away.mean() == pytest.approx(0.2 / 2.2, abs=0.03)
    drift = injected(fault("position_drift", start=1.0, velocity=[0.1, -0.2, 0.0]))
    assert drift.own_sample(1, at(6.0)).position == pytest.approx((1.5, 1.0, -5.0))
    assert drift.own_sample(1, at(6.0)).velocity == STILL.velocity
