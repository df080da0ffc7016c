"""Largest link latency by the loss of set-points, against the margins of the linear loop."""

import math
from dataclasses import replace
from pathlib import Path

import pytest
from link_margin_page import STARTS, fly, hover_loop, margins
from page_tables import markdown_table

from gcs.config import SystemConfig
from gcs.flight.link_limit import latency_limit
from idc_controller.control.delay_margin import expected_extra_age

SYSTEM = SystemConfig()
PERIOD, SETTINGS = 1.0 / SYSTEM.rates.control, SYSTEM.flight.failsafe


@pytest.fixture(scope="module")
def loop():
    return hover_loop()


def steps(latency):
    """Return the age of the newest known state, in control periods, when set-points act after ``latency`` (s)."""
    return math.ceil((2.0 * latency + 1.0 / SYSTEM.rates.telemetry) / PERIOD - 1e-9)


def test_latency_limit_falls_with_the_loss_from_the_one_without_to_the_one_of_any_loss():
    limits = [latency_limit(SETTINGS, loss, PERIOD) for loss in (0.0, 0.1, 0.15, 0.18, 0.3, 1.0)]
    assert limits[:2] == [SETTINGS.latency_limit] * 2
    assert limits[1] > limits[2] > limits[3] > limits[4]
    assert limits[4:] == [SETTINGS.latency_any_loss] * 2


def test_latency_limit_that_is_set_below_that_of_any_loss_does_not_rise_with_the_loss():
    strict = replace(SETTINGS, latency_limit=0.6 * SETTINGS.latency_any_loss)
    for loss in (0.0, 0.15, 1.0):
        assert latency_limit(strict, loss, PERIOD) == pytest.approx(strict.latency_limit)


def test_ages_that_losses_may_add_are_a_third_of_what_the_loop_bears(loop):
    for latency, age in zip((SETTINGS.latency_limit, SETTINGS.latency_any_loss), SETTINGS.loss_age, strict=True):
        margin = expected_extra_age(loop.loss_margin(steps(latency)), PERIOD)
        assert age / margin == pytest.approx(1 / 3, abs=0.03)


def test_growth_without_loss_is_that_of_the_loop_whatever_the_delay_that_is_compensated(loop):
    assert loop.spectral_radius(0.0) < 1.0
    for age in (1, 4):
        assert loop.mean_square_growth(age, 0.0) == pytest.approx(loop.spectral_radius(0.0) ** 2, rel=0.02)


def test_loop_whose_delay_is_not_compensated_is_unstable_beyond_its_margin(loop):
    margin = loop.delay_margin()
    assert loop.spectral_radius(margin - 0.002) < 1.0 < loop.spectral_radius(margin + 0.002)


@pytest.mark.parametrize("share", [1 / 3, 1.0, 1.6])
def test_loop_bears_a_lost_setpoint_that_it_does_not_know_of_whatever_the_payload(loop, share):
    mass = share * SYSTEM.payload.mass
    assert loop.spectral_radius(0.0, mass) < 1.0
    assert loop.delay_margin(mass) > PERIOD


def test_delay_of_whole_periods_is_the_limit_of_one_that_is_a_little_shorter(loop):
    for periods in (1, 2):
        exactly = loop.spectral_radius(periods * PERIOD)
        assert loop.spectral_radius(periods * PERIOD - 1e-6) == pytest.approx(exactly, rel=1e-3)


def test_table_of_the_page_is_the_computed_one():
    page = (Path(__file__).parents[2] / "docs" / "link-margin.md").read_text(encoding="utf-8")
    assert markdown_table(margins()) in page, "run tests/pages/link_margin_page.py docs/link-margin.md --margins"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("latency", "loss", "seed"),
    # The first command to hold to a vehicle is lost, or comes with the second, or the last plan before it is lost.
    [(0.1, 0.2, 7719), (0.125, 0.2, 4101), pytest.param(0.15, 0.5, 7719, marks=pytest.mark.long)],
)
def test_vehicles_are_landed_together_where_the_command_to_one_of_them_is_lost(latency, loss, seed):
    flown = fly(STARTS[1], latency, loss, seed=seed)
    assert flown.outcome == "aborted" and not flown.is_lost, flown
