from vehicle_sim.autopilot.failsafe import FAILSAFES
from vehicle_sim.autopilot.free import failsafe as free


def test_notices_of_failsafes_fit_one_statustext():
    assert all(len(failsafe.notice) <= 50 for failsafe in (*FAILSAFES, *free.FAILSAFES))
