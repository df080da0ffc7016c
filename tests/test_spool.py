"""Thrust while the payload stands: it grows, and fades once no link leans any more."""

import pytest

from gcs.flight.spool import LEAN, SPOOL_DOWN, SPOOL_UP, STANDING_SHARE, UPRIGHT_TIMEOUT, SpoolDown, spooling_up


def test_it_grows_to_the_hover_thrust():
    assert [spooling_up(SPOOL_UP * part) for part in (0.0, 0.5, 2.0)] == pytest.approx([0.0, 0.5, 1.0])


def test_upright_it_fades_at_once():
    spool = SpoolDown(10.0)
    for k in range(50):
        elapsed = 0.05 * k
        assert spool.share(10.0 + elapsed, 0.0) == pytest.approx(max(1.0 - elapsed / SPOOL_DOWN, 0.0), abs=0.03)


def test_leaning_it_waits_and_then_fades_from_there():
    spool = SpoolDown(10.0)
    for k in range(30):
        assert spool.share(10.0 + 0.1 * k, 2.0 * LEAN) >= STANDING_SHARE
    assert spool.share(13.0, 0.5 * LEAN) == pytest.approx(STANDING_SHARE)
    assert spool.share(13.0 + 0.5 * STANDING_SHARE * SPOOL_DOWN, 2.0 * LEAN) == pytest.approx(0.5 * STANDING_SHARE)


def test_it_does_not_wait_for_ever():
    spool = SpoolDown(10.0)
    assert spool.share(10.0 + UPRIGHT_TIMEOUT + 0.05, 1.0) == pytest.approx(STANDING_SHARE)
    assert spool.share(10.0 + UPRIGHT_TIMEOUT + SPOOL_DOWN + 0.05, 1.0) == 0.0
