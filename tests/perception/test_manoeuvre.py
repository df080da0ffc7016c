"""Manoeuvre detection: model mismatch and prediction error of obstacles."""

import numpy as np
import pytest

from idc_controller.perception.manoeuvre import ManoeuvreDetector
from idc_controller.perception.motion_imm import MotionImm, MotionModels
from idc_controller.perception.settings import ManoeuvreSettings

SETTINGS = ManoeuvreSettings()
SIGMA = 0.03
VARIANCE = np.full(3, SIGMA**2)
STEP = 0.1


def detector_of(motion, until, seed=1):
    """The detector of an obstacle whose ``motion`` an IMM filter follows."""
    rng = np.random.default_rng(seed)
    imm = MotionImm(MotionModels(), 0.0, motion(0.0), VARIANCE)
    detector = ManoeuvreDetector(0.0, SETTINGS)
    for k in range(1, round(until / STEP) + 1):
        imm.advance(STEP * k)
        detector.advance(imm.time)
        detector.add_innovation(imm.update(motion(imm.time) + SIGMA * rng.standard_normal(3), VARIANCE))
        detector.compare(*imm.state[:2])
        if detector.is_settled:
            mean, covariance = imm.predict(np.array([imm.time + SETTINGS.horizon]))
            detector.add_prediction(mean[0], np.sqrt(np.trace(covariance[0])))
    return detector


def along_north(distance):
    return lambda t: np.array([distance(t), 0.0, 0.0])


def detectors(motion, until):
    return [detector_of(motion, until, seed) for seed in range(1, 11)]


def stopping(t):
    return 2.0 * min(t, 5.0)


def test_detector_finds_no_manoeuvre_in_steady_motion():
    worst = max(detectors(along_north(lambda t: 2.0 * t), until=8.0), key=lambda detector: detector.prediction_error)
    assert worst.prediction_error < 0.25
    assert worst.growth_limit(0.0) < SETTINGS.growth_limit - 0.5


def test_detector_finds_mismatch_of_obstacle_that_stops():
    steady = detectors(along_north(lambda t: 2.0 * t), until=6.0)
    stopped = detectors(along_north(stopping), until=6.0)
    assert np.mean([detector.model_mismatch for detector in steady]) < 0.5
    assert min(detector.model_mismatch for detector in stopped) > 0.6
    detector = stopped[0]
    spread = np.sqrt(detector.variance(np.array([1.0, 2.0])))
    assert spread[0] > 0.6 * 0.5 * SETTINGS.mismatch_acceleration
    assert spread[1] == pytest.approx(4.0 * spread[0])


def test_detector_finds_prediction_error_of_obstacle_that_stops_and_starts_again():
    def stops_and_goes(t):
        return 2.0 * (min(t, 5.0) + max(t - 7.0, 0.0))

    before = detector_of(along_north(stops_and_goes), until=4.9)
    after = detector_of(along_north(stops_and_goes), until=7.0)
    assert before.prediction_error < 0.2
    assert after.prediction_error > 0.8  # of 2 m that it was expected to go
    assert after.growth_limit(0.0) == SETTINGS.growth_limit


def test_prediction_error_decays():
    detector = ManoeuvreDetector(0.0, SETTINGS)
    detector.advance(4.0)
    detector.add_prediction(np.zeros(3), 0.1)
    detector.advance(5.0)
    detector.compare(np.array([0.65, 0.0, 0.0]), np.zeros(3))
    assert detector.prediction_error == pytest.approx(0.5)
    assert detector.growth_limit(0.0) == pytest.approx(SETTINGS.growth_max + 0.5 * SETTINGS.growth_per_error)
    detector.advance(5.0 + SETTINGS.memory)
    assert detector.prediction_error == pytest.approx(0.5 / np.e)


@pytest.mark.parametrize(("expected", "counted"), [(0.7, 0.0), (0.6, 0.5)])
def test_error_that_a_prediction_expects_of_itself_is_no_manoeuvre(expected, counted):
    detector = ManoeuvreDetector(0.0, SETTINGS)
    detector.advance(4.0)
    detector.add_prediction(np.zeros(3), expected)
    detector.advance(5.0)
    detector.compare(np.array([0.65, 0.0, 0.0]), np.zeros(3))
    assert detector.prediction_error == pytest.approx(counted)


def test_prediction_between_frames_is_compared_at_its_time():
    detector = ManoeuvreDetector(0.0, SETTINGS)
    detector.advance(4.0)
    detector.add_prediction(np.array([1.0, 0.0, 0.0]), 0.1)
    detector.advance(5.04)
    detector.compare(np.array([1.04, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    assert detector.prediction_error == 0.0


def test_obstacle_just_detected_is_taken_for_one_that_has_moved_steadily():
    new, steady = ManoeuvreDetector(0.0, SETTINGS), ManoeuvreDetector(0.0, SETTINGS)
    for _ in range(200):
        steady.add_innovation(0.5)  # of models that fit: mean over the axes, normalised
    assert steady.model_mismatch == 0.0
    for mean_square in (1.5, 3.0, 4.0):
        new.add_innovation(mean_square)
        steady.add_innovation(mean_square)
    assert 0.0 < steady.model_mismatch < 1.0
    assert new.model_mismatch == pytest.approx(steady.model_mismatch)


@pytest.mark.parametrize("mean_square", [SETTINGS.mismatch_begin, SETTINGS.mismatch_full, 1e9])
def test_lasting_innovations_are_no_mismatch_up_to_one_limit_and_a_whole_one_from_the_other(mean_square):
    detector = ManoeuvreDetector(0.0, SETTINGS)
    for _ in range(300):
        detector.add_innovation(mean_square)
    expected = 0.0 if mean_square == SETTINGS.mismatch_begin else 1.0
    assert detector.model_mismatch == pytest.approx(expected, abs=1e-9)


def test_what_is_learnt_of_the_shape_is_no_mismatch_once_it_is_settled():
    detector = ManoeuvreDetector(0.0, SETTINGS)
    for time in (0.1, 0.2, 0.3):
        detector.advance(time)
        detector.add_innovation(5.0)
    assert detector.model_mismatch > 0.5
    detector.advance(SETTINGS.settling + 0.1)
    detector.add_innovation(0.5)
    assert detector.model_mismatch == 0.0


def test_motion_is_predictable_once_compared_until_a_prediction_proves_wrong():
    detector = ManoeuvreDetector(0.0, SETTINGS)
    for time, error, predictable in ((3.5, 0.0, False), (4.5, 0.0, True), (5.5, 2.0, False)):
        detector.advance(time)
        detector.compare(np.array([error, 0.0, 0.0]), np.zeros(3))
        assert detector.is_predictable is predictable
        detector.add_prediction(np.zeros(3), 0.1)
    assert detector.is_unpredictable
