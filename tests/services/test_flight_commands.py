"""Commands that an aircraft flies: what each asks of it, and what is refused before it is asked."""

from __future__ import annotations

import math
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from service_bench import COMPONENT, HOME_ALTITUDE, NAN, REFUSED, SYSTEM, ServiceBench, command, command_int

from gcs.mavlink import px4
from gcs.mavlink.newer_messages import COMMAND_CANCEL, NEWER, RESULT_UNSUPPORTED_FRAME
from gcs.mavlink.services.aircraft import Orbit, Place, Turn

ACCEPTED, DENIED = mavlink.MAV_RESULT_ACCEPTED, mavlink.MAV_RESULT_DENIED
UNSUPPORTED = mavlink.MAV_RESULT_UNSUPPORTED
GLOBAL, GLOBAL_INT = mavlink.MAV_FRAME_GLOBAL, mavlink.MAV_FRAME_GLOBAL_INT
RELATIVE, RELATIVE_INT = mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT, mavlink.MAV_FRAME_GLOBAL_RELATIVE_ALT_INT


@pytest.mark.parametrize(
    ("message", "call"),
    [
        (command(400, 1), ("arm", False)),
        (command(400, 1, px4.FORCE_ARM_DISARM), ("arm", True)),
        (command(400, 0), ("disarm", False)),
        (command(185, 1), ("disarm", True)),
        (command(22, 0, 0, 0, NAN, NAN, NAN, 500.0), ("take_off", 500.0)),
        (command_int(22, RELATIVE, z=12.0), ("take_off", HOME_ALTITUDE + 12.0)),
        (command_int(22, GLOBAL_INT, z=12.0), ("take_off", 12.0)),
        (command(20), ("enter_mode", px4.MODE_RETURN)),
        (command(21), ("enter_mode", px4.MODE_LAND)),
        (command(178, 1, 4.5, -1), ("change_speed", 4.5)),
        (command(115, 90, 20, -1, 0), ("turn", Turn(math.pi / 2, math.radians(20.0), -1, False))),
        (command(34, -8, 3, 1, 2.5, 47.5, 8.5, 500), ("orbit", Orbit(-8.0, 3.0, 1, 2.5, Place(47.5, 8.5, 500.0)))),
        (command(34, 8, 3, 0, 0, 47.5, 8.5, 500), ("orbit", Orbit(8.0, 3.0, 0, math.inf, Place(47.5, 8.5, 500.0)))),
        (command(179, 1), ("set_home", None)),
        (command(179, 0, 0, 0, 0, 47.5, 8.5, 500), ("set_home", Place(47.5, 8.5, 500.0))),
        (command_int(179, RELATIVE, x=475000000, y=85000000, z=5.0), ("set_home", (47.5, 8.5, HOME_ALTITUDE + 5.0))),
        (command(300, 2, 9), ("start_mission", 2)),
        (command(300, NAN), ("start_mission", 0)),
        (command(193, 0), ("pause",)),
        (command(193, 1), ("resume",)),
        (command(176, 1, 4, 3), ("enter_mode", px4.MODE_HOLD)),
        (command(262, mavlink.MAV_STANDARD_MODE_MISSION), ("enter_mode", px4.MODE_MISSION)),
    ],
)
def test_command_asks_the_aircraft_once_and_gives_its_answer(message: Any, call: tuple[Any, ...]) -> None:
    bench = ServiceBench()
    assert bench.ask(message) == (ACCEPTED, "", []) and bench.aircraft.calls == [call]
    bench.aircraft.answer = REFUSED
    assert bench.ask(message)[:2] == (DENIED, "Recorder denied: because")


@pytest.mark.parametrize("frame", [GLOBAL, GLOBAL_INT, RELATIVE, RELATIVE_INT])
def test_reposition_in_whole_numbers_is_above_the_sea_or_above_home(frame: int) -> None:
    bench = ServiceBench()
    base = HOME_ALTITUDE if frame in (RELATIVE, RELATIVE_INT) else 0.0
    message = command_int(192, frame, 3.0, 1.0, 0.0, 1.5, x=473977420, y=-85455940, z=20.0)
    assert bench.ask(message) == (ACCEPTED, "", [])
    [(name, goal)] = bench.aircraft.calls
    assert name == "reposition"
    assert goal == (pytest.approx(47.397742), pytest.approx(-8.545594), base + 20.0, 1.5, 3.0)


def test_reposition_leaves_open_what_is_not_given() -> None:
    bench = ServiceBench()
    for message in (
        command(192, -1, 1, 0, NAN, NAN, NAN, NAN),
        command_int(192, GLOBAL_INT, -1, 1, 0, NAN, x=0x7FFFFFFF, y=0x7FF80000, z=NAN),
    ):
        assert bench.ask(message)[0] == ACCEPTED
    assert all(math.isnan(value) for _, goal in bench.aircraft.calls for value in goal)
    assert bench.ask(command(192, 2.5, 1, 0, 0.5, 47.25, 8.5, 500))[0] == ACCEPTED
    assert bench.aircraft.calls[-1] == ("reposition", (47.25, 8.5, 500.0, 0.5, 2.5))


@pytest.mark.parametrize("number", [22, 34, 179, 192])
@pytest.mark.parametrize("frame", [mavlink.MAV_FRAME_LOCAL_NED, mavlink.MAV_FRAME_BODY_FRD, 99])
def test_place_in_another_frame_is_refused_as_such(number: int, frame: int) -> None:
    bench = ServiceBench()
    result, text, _ = bench.ask(command_int(number, frame, z=10.0))
    assert result == RESULT_UNSUPPORTED_FRAME == 9 and "MAV_FRAME" in text and bench.aircraft.calls == []


@pytest.mark.parametrize(
    ("message", "parameter"),
    [
        (command(400, 2), 1), (command(400, NAN), 1), (command(185, NAN), 1), (command(185, 2), 1),
        (command(178, 2, 3.0), 1), (command(178, 1, 0.0), 2),
        (command(178, 1, -2.0), 2), (command(178, 1, math.inf), 2), (command(178, 1, NAN), 2), (command(193, 2), 1),
        (command(300, -1), 1), (command(300, 1.5), 1), (command(192, 0, 0, 0, 0, 91.0, 0.0, 0.0), 5),
        (command(192, 0, 0, 0, 0, 0.0, -181.0, 0.0), 6), (command(192, 0, 0, 0, 0, 0, 0, math.inf), 7),
        (command(192, 0, 1, 0, math.inf), 4), (command(192, 0, 1, 0, -math.inf), 4),
        (command(22, 0, 0, 0, NAN, NAN, NAN, math.inf), 7),
        (command(262, 99), 1), (command(262, NAN), 1),
        (command(115, NAN), 1), (command(115, 361), 1), (command(115, 0, -1), 2), (command(115, 0, 0, 2), 3),
        (command(115, 0, 0, 0, 2), 4), (command(179, 2), 1), (command(179, 0, 0, 0, 0, NAN, 8, 500), 5),
        (command(179, 0, 0, 0, 0, 47, 181, 500), 6), (command(179, 0, 0, 0, 0, 47, 8, NAN), 7),
        (command(179, 0, 0, 0, 0, 47, 8, math.inf), 7),
        (command(34, 0, 1), 1), (command(34, math.inf, 1), 1), (command(34, 5, 0), 2), (command(34, 5, math.inf), 2),
        (command(34, 5, 1, 4), 3), (command(34, 5, 1, 0, -1), 4), (command(34, 5, 1, 0, 0, 91), 5),
    ],
)  # fmt: skip
def test_wrong_parameter_is_named_and_nothing_is_asked(message: Any, parameter: int) -> None:
    bench = ServiceBench()
    result, text, _ = bench.ask(message)
    assert (result, bench.wrong_parameter) == (DENIED, parameter) and "denied" in text and bench.aircraft.calls == []


@pytest.mark.parametrize("flags", [0, 2, 3, NAN])
def test_reposition_without_a_change_of_mode_is_unsupported_as_by_px4(flags: float) -> None:
    bench = ServiceBench()
    result, text, _ = bench.ask(command(192, -1, flags, 0, NAN, NAN, NAN, NAN))
    assert result == UNSUPPORTED and "CHANGE_MODE" in text and bench.aircraft.calls == []


@pytest.mark.parametrize("message", [command(178, 1, -1), command(185, 0)])
def test_command_for_nothing_is_accepted(message: Any) -> None:
    bench = ServiceBench()
    assert bench.ask(message) == (ACCEPTED, "", []) and bench.aircraft.calls == []


@pytest.mark.parametrize("number", [187, 209, 310, 420, 2000, 65535])
def test_unknown_command_is_unsupported(number: int) -> None:
    assert ServiceBench().ask(command(number, 1)) == (UNSUPPORTED, "", [])


def test_repeated_command_is_answered_and_not_done_again() -> None:
    bench = ServiceBench()
    for confirmation in range(3):
        assert bench.ask(command(400, 1, confirmation=confirmation))[0] == ACCEPTED
    assert bench.aircraft.calls == [("arm", False)]
    bench.ask(command(400, 0, confirmation=3))  # another one
    bench.ask(command(400, 1, confirmation=3))
    assert len(bench.aircraft.calls) == 3
    bench.ask(command(400, 1, confirmation=3))  # no higher number: sent anew
    bench.ask(command(400, 1, confirmation=4), component=1)  # of another component
    assert len(bench.aircraft.calls) == 5
    bench.now += 60.0
    bench.ask(command(400, 1, confirmation=5))
    assert len(bench.aircraft.calls) == 6


def test_refused_command_may_be_tried_again() -> None:
    bench = ServiceBench()
    bench.aircraft.answer = REFUSED
    bench.ask(command(400, 1))
    bench.aircraft.answer = REFUSED._replace(result=ACCEPTED, text="")
    assert bench.ask(command(400, 1, confirmation=1))[0] == ACCEPTED and len(bench.aircraft.calls) == 2


def test_cancelled_command_is_answered_with_its_result() -> None:
    bench = ServiceBench()

    def cancel(number: int) -> list[Any]:
        return bench.request(NEWER[COMMAND_CANCEL](SYSTEM, COMPONENT, number))

    assert cancel(22) == []
    bench.ask(command(22, 0, 0, 0, NAN, NAN, NAN, 500.0))
    [ack] = cancel(22)
    assert (ack.command, ack.result) == (22, ACCEPTED)
    assert cancel(400) == [] and len(bench.aircraft.calls) == 1


def test_command_to_all_systems_is_for_aircraft_that_obey_it() -> None:
    bench = ServiceBench()
    assert bench.ask(command(400, 1, system=0))[0] == ACCEPTED and len(bench.aircraft.calls) == 1
    bench.aircraft.obeys_broadcasts = False
    for message in (command(400, 1, system=0), command(176, 1, 6, system=0), command(245, 1, system=0)):
        result, text, _ = bench.ask(message)
        assert result == DENIED and "all systems" in text
    [text] = bench.request(mavlink.MAVLink_set_mode_message(0, 1, px4.MODE_HOLD))[:1]
    assert text.get_type() == "STATUSTEXT" and len(bench.aircraft.calls) == 1
    assert bench.ask(command(410, system=0))[0] == ACCEPTED


def test_stranger_gets_information_only() -> None:
    bench = ServiceBench()
    bench.stranger = True
    for number in (400, 22, 192, 176, 245, 246, 401, 420):
        result, text, _ = bench.ask(command(number, 1))
        assert result == DENIED and "another ground" in text
    for number in (410, 519, 510):
        assert bench.ask(command(number))[0] == ACCEPTED
    assert bench.aircraft.calls == []
