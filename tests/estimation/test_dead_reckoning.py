"""Dead reckoning: positions that contradict their own velocities, attitudes their rates."""

import numpy as np
import pytest
from quaternions import quaternion_product

from idc_controller.estimation.health.sensor_health import DeadReckoning
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position, SampleStack, SensorGroup
from idc_controller.estimation.settings import DeadReckoningSettings
from idc_controller.rotations import quaternion_from_euler

VEHICLES = 4
SEEDS = [0, *(pytest.param(seed, marks=pytest.mark.long) for seed in (1, 2))]
WINDOW = DeadReckoningSettings().window
INTERVAL = 0.04  # s
NOISE = 0.02  # m and m/s
POSITIONS = SensorGroup(of_payload=False, kind=Position)


def add(reckoning, *samples):
    """Add measurements of one moment."""
    sources, is_position = np.array([s.source for s in samples]), np.array([isinstance(s, Position) for s in samples])
    values = np.concatenate([part for sample in samples for part in (sample.pose, sample.motion)])
    values.flags.writeable = False
    reckoning.add(SampleStack(np.array([sample.time for sample in samples]), sources, is_position, values))


def path(t):
    """Position and velocity in a quick figure eight."""
    return (
        np.array([4.0 * np.sin(0.7 * t), 3.0 * np.sin(1.4 * t), -5.0]),
        np.array([2.8 * np.cos(0.7 * t), 4.2 * np.cos(1.4 * t), 0.0]),
    )


def inconsistent_after(duration, spoil, seed=1, begin=5.0, group=POSITIONS):
    """Return after which time since ``begin`` (s) a ``group`` alone is inconsistent; None: not within ``duration``.

    ``spoil(source, elapsed, position, velocity, rng)`` gives position and velocity from ``begin`` on.
    """
    rng, reckoning = np.random.default_rng(seed), DeadReckoning(VEHICLES)
    for k in range(round((begin + duration) / INTERVAL)):
        t = k * INTERVAL
        for source in (PAYLOAD, *range(VEHICLES)):
            position, velocity = path(t)
            position = position + NOISE * rng.standard_normal(3)
            velocity = velocity + NOISE * rng.standard_normal(3)
            if t >= begin:
                position, velocity = spoil(source, t - begin, position, velocity, rng)
            add(reckoning, Position(t, source, position, velocity))
        if reckoning.inconsistent_groups:
            assert reckoning.inconsistent_groups == (group,)
            return t - begin
    return None


NORTH = np.array([1.0, 0.0, 0.0])


def of_vehicles(change):
    return lambda source, elapsed, p, v, rng: (p, v) if source == PAYLOAD else change(elapsed, p, v, rng)


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "change",
    [
        lambda elapsed, p, v, rng: (p + 0.1 * elapsed * NORTH, v),
        lambda elapsed, p, v, rng: (p + 0.07 * elapsed * NORTH, v),
        lambda elapsed, p, v, rng: (p + 0.5 * NORTH, v),
        lambda elapsed, p, v, rng: (p, v - 0.2 * NORTH),
        lambda elapsed, p, v, rng: (1.1 * p, v),
    ],
    ids=["drift", "slow drift", "bias", "velocity biased", "scale"],
)
def test_vehicles_positions_are_inconsistent_within_the_window(change, seed):
    found = inconsistent_after(WINDOW, of_vehicles(change), seed)
    assert found is not None and found > 0.0


def spikes(p, v, rng):
    return p + 2.0 * (rng.random(3) < 0.2) * rng.choice([-1.0, 1.0], 3), v


@pytest.mark.slow
@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize(
    "spoil",
    [
        lambda source, elapsed, p, v, rng: (p, v),
        lambda source, elapsed, p, v, rng: (p + 5.0 * NOISE * rng.standard_normal(3), v),
        lambda source, elapsed, p, v, rng: spikes(p, v, rng),
        lambda source, elapsed, p, v, rng: (p + 0.1 * elapsed * NORTH * (source in (0, 1)), v),
        lambda source, elapsed, p, v, rng: (p + 0.1 * elapsed * NORTH, v),
        lambda source, elapsed, p, v, rng: (np.full(3, np.nan), v),
    ],
    ids=["nominal", "noise times 5", "spikes", "two of four", "the payload unit, too", "unknown"],
)
def test_valid_or_noisy_positions_are_consistent(spoil, seed):
    assert inconsistent_after(30.0, spoil, seed) is None


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    "change",
    [
        lambda elapsed, p, v: (p, v + 0.5 * NORTH),
        lambda elapsed, p, v: (p, v + 0.1 * elapsed * NORTH),
        lambda elapsed, p, v: (p + 0.5 * NORTH, v),
    ],
    ids=["velocity biased", "velocity drifts", "bias"],
)
def test_payload_position_is_inconsistent_when_only_its_unit_is_biased(change, seed):
    def spoil(source, elapsed, p, v, rng):
        return change(elapsed, p, v) if source == PAYLOAD else (p, v)

    found = inconsistent_after(2.0 * WINDOW, spoil, seed, group=SensorGroup(True, Position))
    assert found is not None and found > 0.0


def attitude_inconsistent_after(duration, bias, jump=0.0, begin=5.0, seed=1):
    """As above, of the payload's attitude; ``bias`` of its rates (rad/s), ``jump`` of its roll (rad)."""
    rng, reckoning, q = np.random.default_rng(seed), DeadReckoning(VEHICLES), np.array([1.0, 0.0, 0.0, 0.0])
    for k in range(round((begin + duration) / INTERVAL)):
        t = k * INTERVAL
        rates = np.array([0.3 * np.sin(t), 0.2 * np.cos(1.3 * t), 0.1])
        is_off = t >= begin
        noisy = quaternion_product(q, quaternion_from_euler(*(rng.normal(0.0, 0.0035, 3) + is_off * jump * NORTH)))
        add(reckoning, Attitude(t, PAYLOAD, noisy, rates + rng.normal(0.0, 0.008, 3) + is_off * bias))
        for _ in range(10):
            q = quaternion_product(q, np.append(1.0, 0.05 * INTERVAL * rates))
        if reckoning.inconsistent_groups:
            assert reckoning.inconsistent_groups == (SensorGroup(True, Attitude),)
            return t - begin
    return None


@pytest.mark.parametrize("seed", SEEDS)
def test_payload_attitude_is_inconsistent_with_biased_rates(seed):
    assert attitude_inconsistent_after(60.0, 0.0, seed=seed) is None
    assert attitude_inconsistent_after(2.0 * WINDOW, 0.1, seed=seed) > 0.0
    assert attitude_inconsistent_after(2.0 * WINDOW, 0.0, jump=0.1, seed=seed) > 0.0


def test_positions_are_consistent_across_a_gap():
    reckoning = DeadReckoning(VEHICLES)
    for k in range(400):
        if k % 100 < 80:
            for source in (PAYLOAD, *range(VEHICLES)):
                add(reckoning, Position(k * INTERVAL, source, *path(k * INTERVAL)))
        assert not reckoning.inconsistent_groups


def test_repeated_sample_counts_once():
    """Relayed by a vehicle whose clock is off; else the noise would seem to be as small as a repetition's."""
    rng, reckoning = np.random.default_rng(1), DeadReckoning(VEHICLES)
    for k in range(1500):
        t = k * INTERVAL
        for source in (PAYLOAD, *range(VEHICLES)):
            p, v = path(t)
            sample = p + rng.normal(0.0, 0.02, 3), v + rng.normal(0.0, 0.008, 3)
            for late in (0.0, 0.006) if source == PAYLOAD else (0.0,):
                add(reckoning, Position(t + late, source, *sample))
        assert not reckoning.inconsistent_groups
