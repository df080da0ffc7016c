"""Lift-off of a payload of unknown mass, on the vertical motion of a team whose thrust grows."""

import numpy as np
import pytest

from gcs.config import SystemConfig
from idc_controller.estimation.lift_off import LiftOffDetector
from idc_controller.estimation.measurements import PAYLOAD, Position
from idc_controller.estimation.settings import LiftOffSettings

P = SystemConfig().parameters()
SETTINGS = LiftOffSettings()
STEP, CONTROL, TELEMETRY, LATENCY = 0.002, 25, 20, 15  # s; the others in steps
RATE = (P.m_0 + P.m.sum()) * P.g / 2.5  # N/s
NOISE = {PAYLOAD: 0.008} | dict.fromkeys(range(P.number_of_uavs), 0.02)  # m/s


def ramp(mass, seconds=5.0, noise=1.0, bias=None, seed=1):
    """Thrust that grows until the lift-off of a payload of ``mass`` (kg) is found: (detector, time, mass, true speed).

    ``bias``: added to the speed of sources (m/s).
    """
    generator, detector = np.random.default_rng(seed), LiftOffDetector(P)
    weight = (mass + P.m.sum()) * P.g
    thrust = speed = commanded = 0.0
    waiting: list[tuple[int, float]] = []
    for k in range(round(seconds / STEP)):
        time = k * STEP
        if k % TELEMETRY == 0:
            for source, sigma in NOISE.items():
                measured = speed + noise * sigma * generator.standard_normal() + (bias or {}).get(source, 0.0)
                detector.add(Position(time, source, np.zeros(3), np.array([0.0, 0.0, -measured])))
        if k % CONTROL == 0:
            found = detector.mass(time)
            if found is not None:
                return detector, time, found, speed
            waiting.append((k + LATENCY, RATE * time))
            detector.command(time + LATENCY * STEP, RATE * time)
        while waiting and waiting[0][0] <= k:
            commanded = waiting.pop(0)[1]
        thrust += (commanded - thrust) * (1.0 - np.exp(-STEP / P.motor_time_constant))
        speed = max(speed + STEP * (thrust / weight - 1.0) * P.g, 0.0)
    return detector, np.nan, None, speed


@pytest.mark.parametrize("share", [0.1, 0.3, 0.65, 1.0, 1.5])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_mass_at_lift_off_is_within_its_uncertainty(share, seed):
    detector, time, mass, speed = ramp(share * P.m_0, seed=seed)
    assert mass == pytest.approx(share * P.m_0, abs=SETTINGS.significance * SETTINGS.mass)
    thrust, estimated = detector.motion(time, mass)
    assert estimated == pytest.approx(speed, abs=0.05) and speed < 0.4
    assert thrust == pytest.approx(RATE * (time - P.motor_time_constant - STEP * (LATENCY + CONTROL / 2)), abs=2.0)


@pytest.mark.parametrize("source", [PAYLOAD, 2])
@pytest.mark.parametrize("bias", [-0.5, 0.5])
def test_one_source_that_is_wrong_changes_neither_lift_off_nor_mass_by_much(source, bias):
    _, time, mass, _ = ramp(1.1, bias={source: bias})
    assert time == pytest.approx(ramp(1.1)[1], abs=0.11)
    assert mass == pytest.approx(1.1, abs=0.3)


@pytest.mark.parametrize("noise", [1.0, 5.0])
def test_payload_that_stands_does_not_lift_off_by_noise(noise):
    assert all(ramp(20.0, noise=noise, seed=seed)[2] is None for seed in range(10))


def test_lift_off_is_found_later_in_more_noise():
    _, time, mass, _ = ramp(1.1, noise=5.0)
    assert time > ramp(1.1)[1] and mass == pytest.approx(1.1, abs=0.5)


def test_without_velocities_of_most_sources_no_lift_off_is_found():
    detector = LiftOffDetector(P)
    detector.command(0.0, 100.0)
    for step in range(20):
        for source in (PAYLOAD, 0):
            detector.add(Position(0.05 * step, source, np.zeros(3), np.array([0.0, 0.0, -1.0])))
        assert detector.mass(0.05 * step) is None
