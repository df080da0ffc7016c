"""Control of a vehicle: who gets it, how long it lasts, which set-points are passed on; at both sides of the limits."""

from types import SimpleNamespace

import pymavlink.dialects.v20.common as mavlink
import pytest

from gcs.config.vehicle_settings import VehicleLinkSettings
from gcs.mavlink.services.answer import ACCEPTED
from vehicle_sim.autopilot.setpoints import AttitudeSetpoint
from vehicle_sim.mavlink.control_owner import ControlOwner

LOSS = 0.5
"""s: time without set-points after which they are lost."""
SETTINGS = VehicleLinkSettings()
GROUND, SAME_ADDRESS, STRANGER = (("10.0.0.1", 1), 255), (("10.0.0.1", 1), 42), (("10.0.0.2", 1), 255)


class Autopilot:
    """An autopilot that keeps the set-points that it is to fly."""

    def __init__(self):
        self.armed, self.wants_setpoints = False, False
        self.state = SimpleNamespace(setpoint_loss_time=LOSS, failsafe=False)
        self.flown, self.entered = [], []

    def follow(self, setpoint, now):
        self.flown.append((setpoint.time_boot_ms, now))

    def enter_offboard(self, setpoint, received, now):
        self.wants_setpoints = True
        self.entered.append((setpoint.time_boot_ms, received, now))
        return ACCEPTED


def setpoint(stamp):
    return AttitudeSetpoint((1.0, 0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.5, stamp)


@pytest.fixture
def owner():
    return ControlOwner(Autopilot(), SETTINGS)


def controlled(owner, since=10.0):
    """The ground in control, whose last set-point came a tenth of a second after ``since`` (s)."""
    owner.take(setpoint(5000), GROUND, since)
    owner.take(setpoint(5100), GROUND, since + 0.1)
    assert owner.enter_offboard(GROUND, since + 0.1) == ACCEPTED
    return owner._autopilot


@pytest.mark.parametrize(
    ("times", "accepted"),
    [([], False), ([10.01], True), ([9.99], False), ([9.0, 10.49], True), ([9.5, 9.51], False), ([9.61, 10.01], True)],
)
def test_offboard_takes_a_fresh_setpoint(owner, times, accepted):
    for k, time in enumerate(times):
        owner.take(setpoint(5000 + k), GROUND, time)
    owner.take(setpoint(1), STRANGER, 10.49)
    answer = owner.enter_offboard(GROUND, 10.5)
    assert (answer.result == mavlink.MAV_RESULT_ACCEPTED) is accepted
    assert owner.in_control(10.5) == (GROUND if accepted else None)
    if accepted:
        assert owner._autopilot.entered == [(5000 + len(times) - 1, times[-1], 10.5)]
    else:
        words = "within 0.5 s of each other" if times and 10.5 - times[-1] < LOSS else "no set-points from you"
        assert answer.result == mavlink.MAV_RESULT_TEMPORARILY_REJECTED and words in answer.text


@pytest.mark.parametrize(("now", "named"), [(10.2, True), (10.0 + 1.01 * LOSS, False)])
def test_refusal_of_offboard_names_why_the_set_points_were_refused(owner, now, named):
    owner.refuse("SET_POSITION_TARGET_LOCAL_NED refused: a force cannot be flown", GROUND, 10.0)
    for sender, expected in ((GROUND, named), (STRANGER, False)):
        text = owner.enter_offboard(sender, now).text
        assert ("a force cannot be flown" in text, "no set-points from you" in text) == (expected, not expected)


def test_refusals_that_are_kept_are_bounded(owner):
    for port in range(2 * SETTINGS.setpoint_streams_max):
        owner.refuse("refused", (("10.0.1.1", port), 255), 10.0)
    assert len(owner._refused) == SETTINGS.setpoint_streams_max


def test_control_lasts_until_setpoints_stop_for_the_loss_time(owner):
    controlled(owner)
    for now, expected in ((10.1 + 0.99 * LOSS, GROUND), (10.1 + 1.01 * LOSS, None)):
        assert owner.in_control(now) == expected
        assert owner.is_stranger(STRANGER, now) is owner.is_stranger(SAME_ADDRESS, now) is (expected is not None)
        assert not owner.is_stranger(GROUND, now)


@pytest.mark.parametrize(("armed", "wants", "expected"), [(1, 1, GROUND), (1, 0, GROUND), (0, 1, GROUND), (0, 0, None)])
def test_control_ends_on_a_disarmed_vehicle_out_of_offboard(owner, armed, wants, expected):
    autopilot = controlled(owner)
    autopilot.armed, autopilot.wants_setpoints = bool(armed), bool(wants)
    assert owner.in_control(10.2) == expected


def test_stranger_at_the_address_of_the_ground_in_control_is_told_from_others(owner):
    assert not owner.is_stranger(STRANGER, 10.0)
    controlled(owner)
    found = [owner.is_stranger_at_its_address(sender, 10.2) for sender in (GROUND, SAME_ADDRESS, STRANGER)]
    assert found == [False, True, False]
    assert not owner.is_stranger_at_its_address(SAME_ADDRESS, 10.1 + 1.01 * LOSS)


def test_setpoints_of_the_ground_in_control_alone_are_flown(owner):
    autopilot = controlled(owner)
    owner.take(setpoint(5150), GROUND, 10.15)
    owner.take(setpoint(5200), STRANGER, 10.2)
    owner.take(setpoint(5200), SAME_ADDRESS, 10.2)
    assert autopilot.flown == [(5150, 10.15)]
    autopilot.wants_setpoints = False
    owner.take(setpoint(5250), GROUND, 10.25)
    assert autopilot.flown == [(5150, 10.15)]


@pytest.mark.parametrize(
    ("stamp", "now"),
    [
        (5100, 10.21), (5099, 10.2), (4101, 10.2), (5099, 10.61),
        (5100, 10.61), (5000, 10.61), (4100, 10.2), (5100, 30.0),
    ],
    ids=[
        "repeat", "overtaken", "just within the window", "overtaken, after a loss", "repeat after a loss",
        "earlier repeat after a loss", "a single older one", "repeat much later",
    ],
)  # fmt: skip
def test_overtaken_setpoint_and_repeat_are_dropped(owner, stamp, now):
    autopilot = controlled(owner)
    owner.take(setpoint(stamp), GROUND, now)
    assert autopilot.flown == []
    assert owner.in_control(10.55) == GROUND and owner.in_control(10.65) is None  # nor do they prolong control


@pytest.mark.parametrize("late", [1.05, 1.2, 2.0, 4.0])
def test_repeats_of_a_whole_stream_are_dropped_also_after_silence(owner, late):
    autopilot, sent = controlled(owner), [(11.0 + 0.02 * k, 6000 + 20 * k) for k in range(100)]
    owner.take(setpoint(5900), GROUND, 10.98)
    arrivals = sorted([*((time, stamp) for time, stamp in sent), *((time + late, stamp) for time, stamp in sent)])
    for time, stamp in arrivals:
        owner.take(setpoint(stamp), GROUND, time)
    assert [stamp for stamp, _ in autopilot.flown] == [5900, *(stamp for _, stamp in sent)]


@pytest.mark.parametrize(
    ("stamps", "flown"),
    [
        ([4000, 4020, 4040], [4020, 4040]), ([4000, 3980, 4000], []), ([4000, 4000, 4020, 4020], [4020, 4020]),
        ([4000, 5120, 4020, 5140], [5120, 5140]), ([4000, 5000, 4020, 4040], [4040]), ([4500, 4520, 4540], []),
    ],
    ids=["twice", "falling", "repeated", "between newer ones", "a repeat between", "overtaken"],
)  # fmt: skip
def test_clock_is_set_back_by_two_new_setpoints_in_a_row(owner, stamps, flown):
    autopilot = controlled(owner)
    for k, stamp in enumerate(stamps):
        owner.take(setpoint(stamp), GROUND, 10.2 + 0.02 * k)
    assert [stamp for stamp, _ in autopilot.flown] == flown


def test_copy_of_the_newest_that_comes_with_it_counts(owner):
    autopilot = controlled(owner)
    owner.take(setpoint(5100), GROUND, 10.15)
    assert autopilot.flown == [(5100, 10.15)]


def test_setpoints_without_stamps_are_flown_as_they_come(owner):
    for time in (10.0, 10.1):
        owner.take(setpoint(0), GROUND, time)
    assert owner.enter_offboard(GROUND, 10.1) == ACCEPTED
    owner.take(setpoint(0), GROUND, 10.2)
    assert owner._autopilot.flown == [(0, 10.2)]


def test_setpoints_of_the_ground_in_control_are_remembered_when_others_come(owner):
    autopilot = controlled(owner)
    owner.take(setpoint(1), STRANGER, 12.0)
    owner.take(setpoint(5100), GROUND, 12.1)
    assert autopilot.flown == []


def test_stop_plans_rise_in_number_and_another_session_begins_with_offboard(owner):
    controlled(owner)
    assert [owner.is_new_plan(3, number) for number in (1, 1, 3, 2, 4)] == [True, False, True, False, True]
    assert not owner.is_new_plan(4, 9)
    assert owner.enter_offboard(GROUND, 10.2) == ACCEPTED
    assert not owner.is_new_plan(3, 4)
    assert owner.is_new_plan(4, 1) and not owner.is_new_plan(3, 5)


def test_stamps_go_on_where_they_wrap_round(owner):
    owner.take(setpoint(0xFFFFFFFF), GROUND, 10.0)
    owner.take(setpoint(9), GROUND, 10.01)
    assert owner.enter_offboard(GROUND, 10.01) == ACCEPTED
    owner.take(setpoint(0xFFFFFFFE), GROUND, 10.02)
    owner.take(setpoint(20), GROUND, 10.03)
    assert owner._autopilot.flown == [(20, 10.03)]


def test_number_of_streams_is_bounded_and_silent_ones_are_forgotten(owner):
    senders = [(("10.0.1.1", port), 255) for port in range(SETTINGS.setpoint_streams_max)]
    for sender in senders:
        owner.take(setpoint(1), sender, 10.0)
    for stamp, now in ((5000, 10.1), (5001, 10.2)):
        owner.take(setpoint(stamp), GROUND, now)
    assert owner.enter_offboard(GROUND, 10.2) != ACCEPTED
    for now in (10.3, 10.49):
        owner.take(setpoint(2), senders[0], now)
    for stamp, now in ((5002, 10.51), (5003, 10.6)):
        owner.take(setpoint(stamp), GROUND, now)
    assert owner.enter_offboard(GROUND, 10.6) == ACCEPTED
    assert owner.enter_offboard(senders[0], 10.6) == ACCEPTED


def test_many_streams_of_one_address_leave_room_for_another(owner):
    for system in range(1, SETTINGS.setpoint_streams_max + 1):
        owner.take(setpoint(5000), (STRANGER[0], system), 10.0)
    controlled(owner)
    assert owner.in_control(10.1) == GROUND
    owner.take(setpoint(5000), (STRANGER[0], 200), 10.1)
    assert owner.enter_offboard((STRANGER[0], 200), 10.1) != ACCEPTED


@pytest.mark.parametrize("clock", [0.0, 2**32 * 1e-3 - 20.0, -15.0])
def test_in_a_failsafe_the_queue_of_a_link_that_has_become_slow_is_not_flown(owner, clock):
    """Whatever clock the stamps are by, wrapping, too."""

    def stamp(time):
        return round(1e3 * (time + clock)) & 0xFFFFFFFF

    autopilot, sent = None, [20.0 + 0.05 * k for k in range(200)]
    for time in sent[:20]:
        owner.take(setpoint(stamp(time)), GROUND, time + 0.01)
        if autopilot is None:
            assert owner.enter_offboard(GROUND, time + 0.01) == ACCEPTED
            autopilot = owner._autopilot
    autopilot.flown.clear()
    autopilot.state.failsafe = True
    for time in sent[20:40]:
        owner.take(setpoint(stamp(time)), GROUND, time + 2.0)
    assert not autopilot.flown
    owner.take(setpoint(stamp(sent[60])), GROUND, sent[60] + 0.02)
    assert len(autopilot.flown) == 1
    autopilot.state.failsafe = False
    owner.take(setpoint(stamp(sent[61])), GROUND, sent[61] + 2.0)
    assert len(autopilot.flown) == 2


def test_in_a_failsafe_a_copy_is_no_other_setpoint(owner):
    autopilot = controlled(owner)
    autopilot.state.failsafe = True
    for number, flown in ((5200, 1), (5200, 1), (5250, 2)):
        owner.take(setpoint(number), GROUND, 10.2)
        assert len(autopilot.flown) == flown
