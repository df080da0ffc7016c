"""Which obstacles are taken to be capable of more than the motion models say, by how much, and for how long."""

import numpy as np
import pytest

from idc_controller.perception.manoeuvre import AHEAD, Agility, AgilitySettings
from idc_controller.perception.motion_imm import BankSettings, MotionBank, MotionModels

SETTINGS = AgilitySettings()
SIGMA = 0.03
VARIANCE = np.full(3, SIGMA**2)
STEP = 0.1


def judged(motion, until, seed=1):
    """The agility of an obstacle whose ``motion`` a bank of filters follows, as its filter would find it."""
    rng = np.random.default_rng(seed)
    bank = MotionBank(MotionModels(BankSettings()), 0.0, motion(0.0), VARIANCE)
    agility = Agility(0.0, SETTINGS)
    for k in range(1, round(until / STEP) + 1):
        bank.advance(STEP * k)
        agility.advance(bank.time)
        agility.innovation(bank.measured(motion(bank.time) + SIGMA * rng.standard_normal(3), VARIANCE))
        agility.judge(*bank.state[:2])
        if agility.is_judged:
            agility.foresee(bank.predict(np.array([bank.time + AHEAD]))[0][0])
    return agility


def along_north(distance):
    return lambda t: np.array([distance(t), 0.0, 0.0])


def agilities(motion, until):
    return [judged(motion, until, seed) for seed in range(1, 11)]


def stopping(t):
    return 2.0 * min(t, 3.0)


def test_steady_motion_is_not_agile():
    worst = max(agilities(along_north(lambda t: 2.0 * t), until=8.0), key=lambda agility: agility.misjudged)
    assert worst.misjudged < 0.25
    assert worst.growth_limit(0.0) < SETTINGS.limit_misjudged - 0.5


def test_what_stops_dead_moves_unlike_any_model():
    steady = agilities(along_north(lambda t: 2.0 * t), until=4.0)
    stopped = agilities(along_north(stopping), until=4.0)
    assert np.mean([agility.unlike for agility in steady]) < 0.5
    assert min(agility.unlike for agility in stopped) > 0.6
    agility = stopped[0]
    spread = np.sqrt(agility.variance(np.array([1.0, 2.0])))
    assert spread[0] > 0.6 * 0.5 * SETTINGS.unlike_acceleration
    assert spread[1] == pytest.approx(4.0 * spread[0])


def test_what_stops_and_goes_off_again_is_misjudged_a_second_later():
    def stops_and_goes(t):
        return 2.0 * (min(t, 5.0) + max(t - 7.0, 0.0))

    before = judged(along_north(stops_and_goes), until=4.9)
    after = judged(along_north(stops_and_goes), until=7.0)
    assert before.misjudged < 0.2
    assert after.misjudged > 0.8  # of 2 m that it was expected to go
    assert after.growth_limit(0.0) == SETTINGS.limit_misjudged


def test_it_is_forgotten():
    agility = Agility(0.0, SETTINGS)
    agility.advance(4.0)
    agility.foresee(np.zeros(3))
    agility.advance(5.0)
    agility.judge(np.array([0.65, 0.0, 0.0]), np.zeros(3))
    assert agility.misjudged == pytest.approx(0.5)
    assert agility.growth_limit(0.0) == pytest.approx(SETTINGS.limit + 0.5 * SETTINGS.limit_share)
    agility.advance(5.0 + SETTINGS.memory)
    assert agility.misjudged == pytest.approx(0.5 / np.e)


def test_what_was_foreseen_for_a_moment_between_frames_is_compared_at_that_moment():
    agility = Agility(0.0, SETTINGS)
    agility.advance(4.0)
    agility.foresee(np.array([1.0, 0.0, 0.0]))
    agility.advance(5.04)
    agility.judge(np.array([1.04, 0.0, 0.0]), np.array([1.0, 0.0, 0.0]))
    assert agility.misjudged == 0.0
