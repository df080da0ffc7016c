"""The team as a whole: who is armed, who can be reached, and when the first would descend."""

from types import SimpleNamespace

import pytest

from gcs.flight.team import Team
from gcs.mavlink import px4

TIMEOUT = 1.0


def team(*vehicles):
    """A team of (armed, age of its telemetry at 10 s)."""
    links = [
        SimpleNamespace(
            status=SimpleNamespace(
                armed=armed, parameters={px4.PARAM_LAND_DELAY: 20.0 - i, px4.PARAM_SETPOINT_LOSS: 0.5 + 0.1 * i}
            ),
            telemetry_received_at=10.0 - age,
        )
        for i, (armed, age) in enumerate(vehicles)
    ]
    return Team(links, None)


@pytest.mark.parametrize(
    ("vehicles", "armed", "disarmed"),
    [
        ([(True, 0.0), (True, 0.0)], True, False),
        ([(True, 0.0), (False, 0.0)], False, False),
        ([(False, 0.0), (False, 0.0)], False, True),
    ],
    ids=["all", "one", "none"],
)
def test_team_is_armed_or_disarmed_if_every_vehicle_is(vehicles, armed, disarmed):
    assert (team(*vehicles).armed, team(*vehicles).disarmed) == (armed, disarmed)


@pytest.mark.parametrize(
    ("vehicles", "expected"),
    [
        ([(False, 0.1), (False, 0.2)], True),
        ([(False, 0.1), (True, 0.2)], False),
        ([(False, 0.1), (True, 1.5)], True),
        ([(False, TIMEOUT), (True, 1.5)], True),
        ([(False, 0.1), (True, TIMEOUT)], False),
        ([(False, 1.5), (False, 1.5)], False),
    ],
    ids=["all", "one is armed", "the armed one is lost", "just in time", "armed, just in time", "all lost"],
)
def test_reachable_vehicles_are_disarmed_if_there_is_one_and_none_is_armed(vehicles, expected):
    assert team(*vehicles).reachable_are_disarmed(10.0, TIMEOUT) is expected


def test_first_vehicle_to_descend_sets_the_land_delay():
    assert team((True, 0.0), (True, 0.0), (True, 0.0)).land_delay == 18.0


def test_team_holds_until_the_first_lands_as_long_as_the_last_waits_for_setpoints():
    assert team((True, 0.0), (True, 0.0), (True, 0.0)).hold == pytest.approx((18.0 + 0.7, 2.0 * 0.7))
