"""Dead reckoning: positions that contradict their own velocities, attitudes their rates."""

from dataclasses import replace

import numpy as np
import pytest

from idc_controller.estimation.health.dead_reckoning import DeadReckoning
from idc_controller.estimation.health.dead_reckoning_kernels import drift_ratio, integrate, reckon
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position, SampleStack, SensorGroup
from idc_controller.estimation.settings import DeadReckoningSettings
from idc_controller.rotations import quaternion_from_euler, quaternion_product

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


def reckoned(times, window=WINDOW):
    """What the kernel returns of positions of one vehicle that are reported at these times, the last of them."""
    s, made = DeadReckoningSettings(), DeadReckoning(1)
    for t in times:
        position, velocity = path(t)
        found = reckon(
            np.array([t]), np.zeros(1, dtype=int), np.array([True]), np.concatenate([position, velocity]), 1, window,
            s.gap, s.samples, s.position_error, s.attitude_error, s.sigmas, made._recent, made._motion,
            made._integral, made._differences, made._counts, made._ratio,
        )  # fmt: skip
    return found, made._recent.shape[1]


def test_window_and_tests_are_counted_from_none():
    (longest, tests), kept = reckoned([1.0])
    assert (longest, tests) == (0, 0)
    (longest, tests), _ = reckoned(1.0 + INTERVAL * np.arange(kept))
    assert longest == 1
    count = round(0.5 * WINDOW / INTERVAL)
    (longest, _), _ = reckoned(1.0 + INTERVAL * np.arange(kept + count))
    assert longest == 1 + count


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


@pytest.mark.parametrize("count", [19, 20, 50, 51])
@pytest.mark.parametrize("n", [8, 9])
def test_compiled_drift_ratio_equals_plain_one(count, n):
    values, error, sigmas = np.random.default_rng(count).standard_normal((count, 3)), 0.03, 5.0
    moved = np.abs(np.median(values[-n:], axis=0) - np.median(values[:n], axis=0))
    sigma = 1.4826 / np.sqrt(2.0) * np.median(np.abs(np.diff(values, axis=0)), axis=0)
    allowed = error + sigmas * 1.2533 * np.sqrt(2.0 / n) * sigma
    window = np.column_stack([0.04 * np.arange(count), values])
    assert drift_ratio(window, n, error, sigmas) == pytest.approx((moved / allowed).max(), rel=1e-12)


def test_drift_ratio_of_a_value_that_is_no_number_is_infinite():
    window = np.zeros((20, 4))
    window[10:, 2] = np.nan  # as an integral leaves it that is none
    assert drift_ratio(window, 8, 0.03, 5.0) == np.inf


@pytest.mark.parametrize("is_position", [True, False])
def test_compiled_integral_equals_plain_one(is_position):
    rng = np.random.default_rng(3)
    integral = np.zeros(3) if is_position else quaternion_from_euler(0.1, -0.2, 0.4)
    plain, motion, difference = integral.copy(), np.zeros(3), np.empty(3)
    for count in (4, 5, 5):
        motions, pose, last = rng.standard_normal((count, 3)), rng.standard_normal(len(integral)), motion.copy()
        integrate(motions, motion, integral, 0.04, pose, difference)
        assert (motion == np.median(motions, axis=0)).all()
        mean = 0.5 * (last + motion)
        if is_position:
            plain = plain + 0.04 * mean
            expected = pose - plain
        else:
            plain = quaternion_product(plain, np.append(1.0, 0.02 * mean))
            plain /= np.linalg.norm(plain)
            rest = quaternion_product(pose, plain * [1.0, -1.0, -1.0, -1.0])
            expected = 2.0 * np.copysign(1.0, rest[0]) * rest[1:]
        assert integral == pytest.approx(plain, rel=1e-13, abs=1e-14)
        assert difference == pytest.approx(expected, rel=1e-12, abs=1e-13)


class PlainCheck:
    """Pose of one source less its integrated motion, one sample after the other."""

    def __init__(self, settings, first):
        self.settings, self.is_position = settings, isinstance(first, Position)
        self.integral = np.zeros(3) if self.is_position else first.pose.copy()
        self.motion, self.recent, self.window, self.untested, self.ratio, self.failed = np.zeros(3), [], [], 0, 0.0, 0

    def add(self, sample):
        s, recent = self.settings, self.recent
        if recent and (sample.time <= recent[-1].time or sample.same_values(recent[-1])):
            return
        if recent and sample.time - recent[-1].time > s.gap:
            self.recent, self.window = recent, _ = [], []
        recent.append(sample)
        del recent[: -s.smoothed]
        if len(recent) == s.smoothed:
            before, middle = recent[s.smoothed // 2 - 1], recent[s.smoothed // 2]
            duration, difference = middle.time - before.time if self.window else 0.0, np.empty(3)
            motions = np.array([near.motion for near in recent])
            integrate(motions, self.motion, self.integral, duration, middle.pose, difference)
            self.window.append([middle.time, *difference])
        self.window = [row for row in self.window if row[0] >= sample.time - s.window]
        self.untested += 1
        if self.untested >= s.samples // 2:
            error = s.position_error if self.is_position else s.attitude_error
            filled = len(self.window) > 2 * s.samples
            self.ratio = drift_ratio(np.array(self.window), s.samples, error, s.sigmas) if filled else 0.0
            self.failed, self.untested = self.failed + 1 if self.ratio > 1.0 else 0, 0


@pytest.mark.parametrize("seed", SEEDS)
def test_all_sources_at_once_equal_one_after_the_other(seed):
    rng, settings, checks = np.random.default_rng(seed), replace(DeadReckoningSettings(), window=13.0), {}
    reckoning, before, was_inconsistent = DeadReckoning(VEHICLES, settings), {}, 0
    for k in range(1200):
        t, samples = k * INTERVAL + (k > 700) * 0.5, []
        for source in (PAYLOAD, *range(VEHICLES)):
            p, v = path(t)
            drift = 0.1 * t * NORTH * (source % 2)
            position = Position(t, source, p + drift + rng.normal(0.0, 0.02, 3), v + rng.normal(0.0, 0.02, 3))
            turn = quaternion_from_euler(*rng.normal(0.0, 0.003, 3))
            samples += [position, Attitude(t, source, turn, rng.normal(0.0, 0.008, 3))]
        for j, sample in enumerate(samples):
            chance = rng.random()
            if chance < 0.05:
                samples[j] = sample.without(pose=chance < 0.02, motion=chance > 0.01)
            elif chance < 0.1:
                samples[j] = replace(sample, time=t - 2.0 * INTERVAL)
            elif chance < 0.15:
                samples[j] = before.get(j, sample)
        before = dict(enumerate(samples))
        samples = [sample for sample in samples if rng.random() < 0.95]
        add(reckoning, *samples)
        for s in samples:
            if s.has_pose and s.has_motion and (s.source == PAYLOAD or isinstance(s, Position)):
                checks.setdefault((s.source, type(s)), PlainCheck(settings, s)).add(s)
        uavs = [checks[i, Position] for i in range(VEHICLES) if (i, Position) in checks]
        for i in range(VEHICLES):
            assert reckoning.is_inconsistent(i) == ((i, Position) in checks and checks[i, Position].ratio > 1.0)
        position, attitude, groups = checks.get((PAYLOAD, Position)), checks.get((PAYLOAD, Attitude)), []
        consistent, failing = settings.consistent_ratio, settings.consecutive
        if position and position.ratio <= consistent and 2 * sum(c.ratio > 1.0 for c in uavs) > VEHICLES:
            groups.append(POSITIONS)
        agreeing = sum(c.ratio <= consistent for c in uavs)
        if position and position.failed >= failing and 2 * agreeing > VEHICLES:
            groups.append(SensorGroup(True, Position))
        if attitude and attitude.failed >= failing:
            groups.append(SensorGroup(True, Attitude))
        assert reckoning.inconsistent_groups == tuple(groups)
        was_inconsistent += sum(reckoning.is_inconsistent(i) for i in range(VEHICLES))
    assert 100 < was_inconsistent < 2500
