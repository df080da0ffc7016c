"""Spool-down: the ground takes the payload over at once; the thrust fades once no link leans any more."""

import numpy as np
import pytest

from gcs.config import SystemConfig
from gcs.config.flight_settings import DEFAULTS
from gcs.flight.spool import Footing, Touchdown
from idc_controller.estimation.grounded_links import S_DOT, LinkStates, S
from idc_controller.trajectory.trajectory import RestTrajectory

SETTINGS = DEFAULTS.takeoff_landing
PARAMETERS = SystemConfig().parameters()
OWN, HOVER = np.full(4, 7.0), np.full(4, 15.0)
FOOTING = Footing(OWN, OWN + 0.5, 0.24, 0.5, 0.16)
STANDING = OWN + FOOTING.carried * (HOVER - OWN)


def touchdown():
    return Touchdown(RestTrajectory(np.zeros(3), 10.0), 0.0, 10.0, FOOTING, SETTINGS)


def thrusts(spool, elapsed, lean=0.0, hover=HOVER, speed=0.0, located=True, flown=None, rate=0.0):
    """Thrusts at ``elapsed`` (s) after touch-down with one link that leans, over a payload that slides.

    ``rate`` (1/s): with which the link of the last UAV moves, which is ``located`` or not.
    """
    x = np.zeros((6, 4, 2))
    x[S, 2, 1], x[S_DOT, 3, 0] = lean, rate
    links = LinkStates(
        x,
        hover if flown is None else flown,
        np.zeros(2),
        np.array([speed, 0.0, 0.0]),
        np.array([True, True, True, located]),
    )
    return spool.thrusts(10.0 + elapsed, hover, links)


def test_spool_down_begins_with_the_payload_and_ends_without_thrust_where_links_are_upright():
    spool = touchdown()
    assert thrusts(spool, 0.0) == pytest.approx(HOVER)
    assert thrusts(spool, SETTINGS.unload_time) == pytest.approx(STANDING)
    fading = [thrusts(spool, SETTINGS.unload_time + 0.1 * k)[0] for k in range(21)]
    assert np.all(np.diff(fading)[: round(STANDING[0] / HOVER[0] * 20) - 1] < 0.0) and fading[-1] == 0.0


def test_spool_down_keeps_uavs_above_their_own_weight_until_leaning_links_are_upright():
    spool = touchdown()
    kept = [thrusts(spool, 0.1 * k, -2.0 * SETTINGS.upright_lean) for k in range(30)]
    assert np.min(kept) == pytest.approx(STANDING[0]) and STANDING[0] > OWN[0]
    assert thrusts(spool, 3.0, 0.5 * SETTINGS.upright_lean) == pytest.approx(STANDING)
    later = 3.0 + 0.5 * SETTINGS.spool_down_time
    assert thrusts(spool, later, 2.0 * SETTINGS.upright_lean) == pytest.approx(STANDING - 0.5 * HOVER)


def test_uavs_keep_above_their_own_weight_over_a_payload_that_weighs_little():
    light = OWN + 0.5
    assert np.all(thrusts(touchdown(), 1.0, 1.0, light) > OWN)


def test_spool_down_waits_for_links_until_its_timeout():
    spool = touchdown()
    assert thrusts(spool, SETTINGS.upright_timeout + 0.05, 1.0) == pytest.approx(STANDING)
    assert not thrusts(spool, SETTINGS.upright_timeout + SETTINGS.spool_down_time + 0.05, 1.0).any()


def test_payload_that_slides_is_carried_less_the_farther_it_has_slid_and_the_thrust_does_not_fade_before_it_rests():
    spool = touchdown()
    kept = np.array([thrusts(spool, 0.05 * k, speed=0.3)[0] for k in range(60)])
    assert np.all(np.diff(kept) <= 0.0) and kept[-1] == pytest.approx(FOOTING.taut[0])
    assert thrusts(spool, 3.0 + 0.05)[0] == pytest.approx(kept[-1])
    assert thrusts(spool, 3.5)[0] < kept[-1]


def test_footing_holds_in_the_strongest_wind_and_beside_a_uav_without_a_position():
    failsafe = DEFAULTS.failsafe
    footing = Footing.of(PARAMETERS, failsafe, SETTINGS, tilt_max=0.3)
    assert (1.0 - footing.carried) * SETTINGS.friction == pytest.approx(failsafe.wind_drag)
    lifted = (footing.carried + footing.carried_unlocated) / PARAMETERS.number_of_uavs
    assert lifted == pytest.approx(0.5 * SETTINGS.least_weight)
    # Tilted, and with mass and thrust off by what is tolerated, a UAV still lifts more than its weight.
    weight, share = PARAMETERS.m * PARAMETERS.g, failsafe.parameter_tolerance
    assert np.all(footing.taut * (1.0 - share) * np.sqrt(1.0 - 0.3**2) > weight)


@pytest.mark.parametrize(("begun", "goes_on"), [(0.1, False), (0.5, True)])
def test_thrust_fades_no_further_over_a_payload_that_is_lifted_while_the_links_are_taut(begun, goes_on):
    spool = touchdown()
    thrusts(spool, SETTINGS.unload_time)
    faded = thrusts(spool, SETTINGS.unload_time + begun)
    assert (faded[0] < OWN[0]) == goes_on
    lifted = [thrusts(spool, 1.0 + begun + 0.05 * k, speed=0.3, flown=faded)[0] for k in range(10)]
    assert (lifted[-1] < OWN[0]) == goes_on


def test_uav_without_a_position_keeps_more_of_its_share_and_stops_with_the_others():
    spool = touchdown()
    waiting = thrusts(spool, 1.0, lean=1.0, located=False)
    assert waiting[:3] == pytest.approx(STANDING[:3])
    assert waiting[3] == pytest.approx(OWN[3] + FOOTING.carried_unlocated * (HOVER[3] - OWN[3]))
    fading = np.array([thrusts(spool, 1.05 + 0.05 * k, located=False) for k in range(50)])
    assert fading[:, 3] / waiting[3] == pytest.approx(fading[:, 0] / waiting[0]) and not fading[-1].any()


def test_link_of_a_uav_without_a_position_must_move_more_slowly_before_the_thrust_fades():
    rate = 0.9 * SETTINGS.upright_lean / SETTINGS.lean_time
    for located, falls in ((True, True), (False, False)):
        spool = touchdown()
        thrusts(spool, 1.0, located=located, rate=rate)
        assert (thrusts(spool, 1.5, located=located, rate=rate)[0] < STANDING[0] - 1.0) == falls
    slower = 0.9 * SETTINGS.upright_lean / SETTINGS.lean_time_unlocated
    spool = touchdown()
    thrusts(spool, 1.0, located=False, rate=slower)
    assert thrusts(spool, 1.5, located=False, rate=slower)[0] < STANDING[0] - 1.0
