"""A stop plan that is followed by dead reckoning, and once the position is measured again."""

import pytest

from gcs.config.vehicle_settings import HoldSettings
from idc_controller.rotations_float import euler_of
from vehicle_sim.autopilot.hold_control import HoldController, HoldPlan
from vehicle_sim.world.sensors import Measurement

PLACE = (10.0, -4.0, -6.0)
DRIFT = (3.0, -1.0, 2.0)


def controller(*, common, offset=DRIFT):
    plan = HoldPlan(0.0, 4.0, (PLACE,) * 5, 0.0, is_common=common)
    return HoldController(plan, 14.0, (0.0, 0.0), 6.2, 9.81, HoldSettings(), offset)


def tilt(hold, position, now, reckoned):
    attitude, thrust = hold.command(
        Measurement(now, (1, 0, 0, 0), (0, 0, 0), position, (0.0, 0.0, 0.0)), now, False, reckoned
    )
    roll, pitch, _ = euler_of(attitude)
    return pytest.approx((roll, pitch, thrust), abs=1e-6)


LEVEL = (0.0, 0.0, 14.0)


@pytest.mark.parametrize("common", [True, False])
def test_plan_is_followed_from_where_the_vehicle_takes_itself_to_be(common):
    hold = controller(common=common)
    reckoned = tuple(p + d for p, d in zip(PLACE, DRIFT, strict=True))
    assert tilt(hold, reckoned, 1.0, True) == LEVEL


def test_plan_of_all_is_followed_where_it_is_once_the_position_is_measured():
    hold = controller(common=True)
    assert tilt(hold, PLACE, 1.0, False) == LEVEL
    assert hold.plan.control_points == (PLACE,) * 5


def test_plan_of_its_own_goes_on_where_the_vehicle_is_once_the_position_is_measured():
    hold = controller(common=False)
    here = (12.0, -5.0, -7.0)
    assert tilt(hold, here, 1.0, False) == LEVEL
    assert hold.plan.control_points[0] == pytest.approx(here)
    assert tilt(hold, here, 2.0, False) == LEVEL


def test_position_that_is_lost_later_does_not_move_the_plan():
    hold = controller(common=True, offset=None)
    assert tilt(hold, PLACE, 1.0, True) == LEVEL
    assert tilt(hold, PLACE, 2.0, False) == LEVEL
