"""Noise adaptation: sensors that are noisier, forces that change faster than assumed."""

from copy import copy
from itertools import count
from types import SimpleNamespace

import numpy as np
import pytest
from flights import InProcessFlight, check_within_limits, short_figure

from gcs.mission.read import read_mission
from idc_controller.estimation.health.noise_adaptation import NoiseAdaptation, Reaction
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Position
from idc_controller.estimation.settings import NoiseAdaptationSettings

KEYS = tuple((source, kind) for source in (PAYLOAD, 0, 1, 2, 3) for kind in (Position, Attitude))
SIZES = np.full(10, 5)
PAYLOAD_ROWS = np.arange(50) < 10


def adapted(innovations):
    adaptation = NoiseAdaptation(3)
    for k, normalised in enumerate(innovations):
        mean_squares = np.add.reduceat(normalised**2, np.arange(0, 50, 5)) / SIZES
        adaptation.learn(0.04 * k, KEYS, normalised, mean_squares, np.ones(50, dtype=bool), PAYLOAD_ROWS)
    return adaptation


def test_scales_stay_one_for_consistent_innovations():
    random = np.random.default_rng(1)
    for _ in range(20):
        adaptation = adapted(random.standard_normal((500, 50)))
        assert (adaptation.measurement_scale, adaptation.level) == (1.0, 0)


def test_measurement_scale_grows_for_large_uncorrelated_innovations():
    adaptation = adapted(3.0 * np.random.default_rng(2).standard_normal((100, 50)))
    assert adaptation.measurement_scale > 50.0
    assert adaptation.level == 0


@pytest.mark.parametrize("of_payload", [True, False])
def test_process_level_rises_for_correlated_innovations(of_payload):
    random = np.random.default_rng(3)
    pushed = np.where(of_payload == PAYLOAD_ROWS, 1.0, 0.0)
    adaptation = adapted(random.standard_normal((200, 50)) + pushed)
    assert adaptation.level == NoiseAdaptationSettings().process_levels
    assert adaptation.measurement_scale == 1.0


@pytest.mark.parametrize(("missing", "rises"), [((), True), ((2,), True), ((1, 2), False), ((0, 1, 2, 3), False)])
def test_process_level_rises_only_with_the_positions_of_all_uavs_but_one(missing, rises):
    keys = tuple(key for key in KEYS if key not in {(i, Position) for i in missing})
    sizes = np.full(len(keys), 5)
    adaptation, rows = NoiseAdaptation(3), np.ones(sizes.sum(), dtype=bool)
    pushed = np.random.default_rng(5).standard_normal((100, rows.size)) + 1.0
    for k, normalised in enumerate(pushed):
        adaptation.learn(0.04 * k, keys, normalised, np.ones(len(keys)), rows, np.arange(rows.size) < 10)
    assert (adaptation.level > 0) is rises


def test_process_level_falls_at_once_when_positions_are_missing_for_longer_than_the_gap():
    pushed = np.random.default_rng(6).standard_normal((100, 50)) + 1.0
    adaptation, attitudes = adapted(pushed), tuple(key for key in KEYS if key[1] is Attitude)
    rows, levels, gap = np.ones(25, dtype=bool), [], NoiseAdaptationSettings().gap
    for k in range(1, 11):
        adaptation.learn(3.96 + 0.03 * k, attitudes, np.ones(25), np.ones(5), rows, np.arange(25) < 5)
        levels.append((0.03 * k > gap, adaptation.level))
    assert all((level == 0) is missing for missing, level in levels)


def test_scales_return_to_one_after_disturbance():
    random = np.random.default_rng(4)
    calm = 0.3 * random.standard_normal((500, 50))
    pushed, noisy = random.standard_normal((200, 50)) + 1.0, 5.0 * random.standard_normal((100, 50))
    adaptation = adapted([*pushed, *noisy, *calm])
    assert (adaptation.measurement_scale, adaptation.level) == (1.0, 0)


def test_level_stays_for_the_dwell_between_two_changes_up_and_down():
    s, adaptation = NoiseAdaptationSettings(), NoiseAdaptation(3)
    levels, rows = [], np.ones(50, dtype=bool)
    for k in range(40 * (s.dwell + 1)):
        # Innovations that keep pointing the same way, then ones that turn round each time.
        same_way = k < 20 * (s.dwell + 1)
        normalised = np.ones(50) * (1.0 if same_way else (-1.0) ** k)
        adaptation.learn(0.04 * k, KEYS, normalised, np.ones(10), rows, PAYLOAD_ROWS)
        levels.append(adaptation.level)
        assert adaptation.process_scale == s.process_step**adaptation.level
        assert adaptation.is_at_limit == (adaptation.level == s.process_levels)
    changes = np.flatnonzero(np.diff(levels))
    assert np.diff(levels)[changes].tolist() == [1] * s.process_levels + [-1] * s.process_levels
    apart = np.diff(changes)
    assert set(apart[: s.process_levels - 1]) == set(apart[s.process_levels :]) == {s.dwell + 1}


@pytest.mark.parametrize(("share", "learns"), [(0.99, True), (1.01, False)])
def test_only_updates_close_to_one_another_are_correlated(share, learns):
    s, adaptation, rows = NoiseAdaptationSettings(), NoiseAdaptation(3), np.ones(50, dtype=bool)
    for k in range(10 * s.dwell):
        adaptation.learn(share * s.gap * k, KEYS, np.ones(50), np.ones(10), rows, PAYLOAD_ROWS)
    assert (adaptation.level > 0) is learns
    assert adaptation.measurement_scale == 1.0


def test_scale_grows_while_the_median_is_beyond_its_limit_and_decays_below_one():
    s, adaptation, rows = NoiseAdaptationSettings(), NoiseAdaptation(3), np.ones(50, dtype=bool)
    times = count(0.0, 1.0)  # s, too far apart for a correlation

    def learned(median, odd=False):
        """Scale after an update of ten measurements, or nine, whose median is this; their innovations are new."""
        keys = KEYS[:-1] if odd else KEYS
        spread = np.linspace(-0.5, 0.5, len(keys))
        adaptation.learn(next(times), keys, np.ones(50), median + spread, rows, rows)
        return adaptation.measurement_scale

    assert learned(0.99 * s.median_limit) == 1.0 and learned(0.99 * s.median_limit, odd=True) == 1.0
    assert learned(1.01 * s.median_limit) == pytest.approx(s.growth)
    assert learned(1.01 * s.median_limit, odd=True) == pytest.approx(s.growth**2)
    assert learned(1.01) == pytest.approx(s.growth**2)
    assert learned(0.99) == pytest.approx(s.growth**2 * s.decay)
    for _ in range(100):
        learned(9.0)
    assert adaptation.measurement_scale == s.measurement_scale_max
    for _ in range(1000):
        learned(0.5)
    assert adaptation.measurement_scale == 1.0


SOURCES = (PAYLOAD, 0, 1, 2, 3)
POSITIONS = tuple((source, Position) for source in SOURCES)
PAYLOAD_LIMIT = 3


def react(adaptation, *rejected, time=1.0, keys=POSITIONS, normalised=None, mean_square=4.0):
    """Reaction where the measurements of these sources are rejected."""
    accepted = np.array([source not in rejected for source, _ in keys])
    mean_squares = np.full(len(keys), mean_square)
    normalised = np.zeros(6 * len(keys)) if normalised is None else normalised
    test = SimpleNamespace(accepted=accepted, normalised=normalised, mean_squares=mean_squares)
    return adaptation.react(time, keys, test)


@pytest.mark.parametrize(
    ("rejected", "expected"),
    [
        ((), "NONE"),
        ((1,), "NONE"),
        ((PAYLOAD, 1), "NONE"),
        ((0, 1, 2), "NOISE_INFLATION"),
        (SOURCES, "NOISE_INFLATION"),
    ],
)
def test_noise_is_inflated_where_most_sources_are_rejected(rejected, expected):
    adaptation = NoiseAdaptation(PAYLOAD_LIMIT)
    assert react(adaptation, *rejected) is Reaction[expected]
    assert adaptation.measurement_scale == (4.0 if expected == "NOISE_INFLATION" else 1.0)


def test_source_that_measures_twice_counts_once():
    """Most sources, not most measurements."""
    keys = ((0, Position), (0, Attitude), (1, Position), (1, Attitude), (2, Position), (3, Position))
    assert react(NoiseAdaptation(PAYLOAD_LIMIT), 0, 1, keys=keys) is Reaction.NONE
    assert react(NoiseAdaptation(PAYLOAD_LIMIT), 0, 1, 2, keys=keys) is Reaction.NOISE_INFLATION


def test_two_sources_are_no_majority():
    assert react(NoiseAdaptation(PAYLOAD_LIMIT), 0, 1, keys=POSITIONS[1:3]) is Reaction.NONE
    assert react(NoiseAdaptation(PAYLOAD_LIMIT), 0, 1, keys=POSITIONS[1:4]) is Reaction.NOISE_INFLATION


def test_scale_grows_with_the_median_of_the_mean_squares_up_to_its_limit():
    adaptation, limit = NoiseAdaptation(PAYLOAD_LIMIT), NoiseAdaptationSettings().measurement_scale_max
    for mean_square, scale in ((0.5, 1.0), (3.0, 3.0), (2.0, 6.0), (1e9, limit), (2.0, limit)):
        react(adaptation, 0, 1, 2, mean_square=mean_square)
        assert adaptation.measurement_scale == pytest.approx(scale)


def test_payload_that_is_rejected_in_a_row_resets_the_covariance():
    adaptation = NoiseAdaptation(PAYLOAD_LIMIT)

    def reactions(*steps):
        return [react(adaptation, *rejected, keys=keys) is Reaction.COVARIANCE_RESET for rejected, keys in steps]

    off, good, vehicle, absent = ((PAYLOAD,), POSITIONS), ((), POSITIONS), ((1,), POSITIONS), ((1,), POSITIONS[1:])
    assert reactions(off, off, off, off) == [False, False, True, True]
    assert reactions(good, off, off, good, off, off) == [False] * 6
    assert reactions(good, off, off, vehicle, off, off) == [False] * 6
    # Where it sends nothing, the row goes on.
    assert reactions(good, off, off, absent, off) == [False, False, False, False, True]


@pytest.mark.parametrize(("share", "gap", "reset"), [(1.01, 0.99, True), (0.99, 0.99, False), (1.01, 1.01, False)])
def test_rejections_that_persist_reset_the_covariance(share, gap, reset):
    """Innovations that point where they pointed at the last moment, which is not long ago."""
    s, adaptation = NoiseAdaptationSettings(), NoiseAdaptation(PAYLOAD_LIMIT)
    cosine = min(share * s.persistent_cosine, 1.0)
    before, now = np.zeros(30), np.zeros(30)
    before[0], now[:2] = 5.0, (3.0 * cosine, 3.0 * np.sqrt(1.0 - cosine**2))
    rows = np.zeros(30, dtype=bool)
    adaptation.learn(1.0, POSITIONS, before, np.ones(5), rows, rows)
    reaction = react(adaptation, 0, 1, 2, time=1.0 + gap * s.gap, normalised=now)
    assert reaction is (Reaction.COVARIANCE_RESET if reset else Reaction.NOISE_INFLATION)


def test_copy_learns_by_itself():
    adaptation = NoiseAdaptation(PAYLOAD_LIMIT)
    other = copy(adaptation)
    react(other, 0, 1, 2)
    assert (adaptation.measurement_scale, other.measurement_scale) == (1.0, 4.0)


def with_faults(folder, *faults):
    mission = short_figure(folder, duration=5.0, altitude=1.5)
    mission.write_text(mission.read_text() + "".join(f"\n[[fault]]\n{fault}\n" for fault in faults))
    return read_mission(mission)


@pytest.mark.slow
def test_flight_stays_within_limits_with_five_times_noise_on_every_channel(tmp_path):
    channels = ("position", "velocity", "attitude", "rates")
    every = [*channels, *(f"payload_{channel}" for channel in channels)]
    mission = with_faults(
        tmp_path, *(f'kind = "noise"\nchannel = "{c}"\nfactor = 5.0\nstart = 5.0' for c in every)
    )  # fmt: skip
    with InProcessFlight(mission, tmp_path / "run", seed=41) as flight:
        flight.fly()
        assert flight.flight.control.estimator.health.adaptation.measurement_scale > 5.0
        check_within_limits(flight.summary(), rmse=0.1)


@pytest.mark.slow
@pytest.mark.long
def test_flight_stays_within_limits_with_a_third_of_datagrams_lost(tmp_path):
    mission = with_faults(tmp_path, 'kind = "packet_loss"\nprobability = 0.3\nstart = 0.0')
    with InProcessFlight(mission, tmp_path / "run", seed=43) as flight:
        flight.fly()
        assert min(link.setpoints.copies for link in flight.station.links) > 1
        check_within_limits(flight.summary())
