"""Spool-down: the thrust fades once no link leans any more."""

import numpy as np
import pytest
from flights import MISSIONS

from gcs.config.flight_settings import DEFAULTS
from gcs.flight.spool import Touchdown, shares_of
from gcs.mission.read import read_mission
from idc_controller.trajectory.trajectory import RestTrajectory

S = DEFAULTS.takeoff_landing


def touchdown():
    return Touchdown(RestTrajectory(np.zeros(3), 10.0), 0.0, 10.0, S)


def test_spool_down_begins_at_once_with_upright_links():
    spool = touchdown()
    for k in range(50):
        elapsed = 0.05 * k
        assert spool.share(10.0 + elapsed, 0.0) == pytest.approx(max(1.0 - elapsed / S.spool_down_time, 0.0), abs=0.03)


def test_spool_down_waits_for_leaning_links_with_less_thrust():
    spool = touchdown()
    shares = [spool.share(10.0 + 0.1 * k, 2.0 * S.upright_lean) for k in range(30)]
    assert min(shares) == shares[-1] == S.leaning_share < S.standing_share
    assert spool.share(13.0, 0.5 * S.upright_lean) == pytest.approx(S.leaning_share)
    assert spool.share(13.0 + 0.5 * S.leaning_share * S.spool_down_time, 2.0 * S.upright_lean) == pytest.approx(
        0.5 * S.leaning_share
    )


def test_spool_down_waits_for_links_until_its_timeout():
    spool = touchdown()
    assert spool.share(10.0 + S.upright_timeout + 0.05, 1.0) == pytest.approx(S.standing_share)
    assert spool.share(10.0 + S.upright_timeout + S.spool_down_time + 0.05, 1.0) == 0.0


def test_shares_are_those_of_the_settings_for_the_stated_payload_and_leave_a_lighter_one_upright():
    parameters = read_mission(MISSIONS / "hop.toml").system.parameters()
    settings, own = DEFAULTS.takeoff_landing, float(parameters.m.sum()) * parameters.g
    stated = float(parameters.hover_thrust.sum())
    assert shares_of(parameters, parameters.m_0, settings) == (settings.standing_share, settings.leaning_share)
    for mass in (2.6, 2.1, 1.0, 0.3):
        hover = own + mass * parameters.g
        standing, leaning = shares_of(parameters, mass, settings)
        pull = (settings.standing_share * stated - own) / (stated - own)
        assert standing * hover == pytest.approx(own + pull * mass * parameters.g)
        assert leaning * hover == pytest.approx(min(settings.leaning_share * stated, standing * hover))
        assert own < leaning * hover < hover
