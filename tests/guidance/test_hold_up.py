"""Hold-up of the mission: when a detour is searched, how often, and when the mission counts as blocked."""

import pytest

from idc_controller.guidance.navigator import HoldUp
from idc_controller.guidance.settings import NavigatorSettings

SETTINGS = NavigatorSettings()
SLOW, FAST = 0.99 * SETTINGS.held_up_rate, 1.01 * SETTINGS.resumed_rate
BETWEEN = 0.5 * (SETTINGS.held_up_rate + SETTINGS.resumed_rate)


def searches(hold_up, rates, begin=100.0, step=0.05, answer="blocked by it"):
    """Times of the searches (s after ``begin``) that find nothing, while the progress has these rates."""
    found = []
    for k, rate in enumerate(rates):
        time = begin + step * k
        if hold_up.search_is_due(time, rate, 0.0):
            hold_up.not_found(time, answer)
            found.append(step * k)
    return found


def test_detour_is_searched_after_the_patience_and_ever_more_rarely():
    found = searches(HoldUp(SETTINGS), [SLOW] * 1000)
    first, most = SETTINGS.search_interval, SETTINGS.search_interval_max
    expected = [SETTINGS.patience]
    # The search that is due doubles the interval until the next.
    for interval in (2.0 * first, 4.0 * first, 8.0 * first, 16.0 * first, 32.0 * first):
        expected.append(expected[-1] + min(interval, most))
    assert found[: len(expected)] == pytest.approx(expected, abs=0.051)


@pytest.mark.parametrize(
    ("rate", "expected"), [(SLOW, True), (SETTINGS.held_up_rate, False), (BETWEEN, False), (FAST, False)]
)
def test_mission_is_held_up_below_its_rate(rate, expected):
    assert bool(searches(HoldUp(SETTINGS), [rate] * 40)) is expected


def test_detour_is_not_searched_before_the_payload_is_about_to_stop():
    """Its trajectory begins at rest; the patience has passed meanwhile."""
    hold_up = HoldUp(SETTINGS)
    for k in range(100):
        assert not hold_up.search_is_due(100.0 + 0.05 * k, SLOW, 1.01 * SETTINGS.begin_speed)
    assert hold_up.search_is_due(105.0, SLOW, 0.99 * SETTINGS.begin_speed)


def test_patience_begins_anew_when_the_mission_goes_on():
    just_less = int(0.9 * SETTINGS.patience / 0.05)
    assert searches(HoldUp(SETTINGS), ([SLOW] * just_less + [BETWEEN]) * 20) == []


def test_mission_is_blocked_once_no_detour_was_found_for_long():
    hold_up = HoldUp(SETTINGS)
    hold_up.not_found(100.0, "blocked by a wall")
    hold_up.not_found(110.0, "blocked by a pole")
    assert hold_up.blocked(100.0 + 0.99 * SETTINGS.give_up) == ""
    assert hold_up.blocked(100.0 + 1.01 * SETTINGS.give_up) == hold_up.reason == "blocked by a pole"


@pytest.mark.parametrize(
    "ends",
    [HoldUp.clear, HoldUp.found, lambda hold_up: hold_up.search_is_due(105.0, FAST, 0.0)],
    ids=["clear", "found", "resumed"],
)
def test_mission_that_goes_on_is_not_blocked(ends):
    hold_up = HoldUp(SETTINGS)
    hold_up.not_found(100.0, "blocked by a wall")
    ends(hold_up)
    assert hold_up.reason == "" and hold_up.blocked(1e6) == ""
    hold_up.not_found(200.0, "blocked by a pole")
    assert hold_up.blocked(200.0 + 0.99 * SETTINGS.give_up) == ""


def test_mission_that_goes_on_slowly_is_still_blocked():
    hold_up = HoldUp(SETTINGS)
    hold_up.not_found(100.0, "blocked by a wall")
    assert not hold_up.search_is_due(105.0, BETWEEN, 0.0)
    assert hold_up.blocked(100.0 + 1.01 * SETTINGS.give_up) == "blocked by a wall"


def test_interval_of_the_search_begins_anew_once_a_detour_is_found():
    """After clearing it does not."""
    hold_up = HoldUp(SETTINGS)
    searches(hold_up, [SLOW] * 400)
    hold_up.clear()
    late = searches(hold_up, [SLOW] * 400, begin=200.0)
    hold_up.found()
    early = searches(hold_up, [SLOW] * 400, begin=300.0)
    first, most = SETTINGS.search_interval, SETTINGS.search_interval_max
    assert late[1] - late[0] == pytest.approx(most, abs=0.051)
    assert early[1] - early[0] == pytest.approx(min(2.0 * first, most), abs=0.051)
