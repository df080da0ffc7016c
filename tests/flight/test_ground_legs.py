"""Legs on the ground between two flights: waits, and commands to grippers until the payload unit answers."""

from types import SimpleNamespace

import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from mission_files import RETURN, TAKE_OFF, A, plan, read, row

from gcs.config.system import SystemConfig
from gcs.flight.ground_legs import GroundLegs
from gcs.flight.mission_legs import MissionLegs
from gcs.mavlink import px4
from gcs.mavlink.requests import Requests
from gcs.mavlink.settings import LinkSettings
from gcs.mission.cargo import CargoState
from gcs.mission.commands import GripperAction
from gcs.mission.read import read_mission
from gcs.mission.route import Gripper, Land, Stand, TakeOff

HERE = (0.0, 0.0, -0.3)
RELEASE = Gripper(HERE, GripperAction.RELEASE, 1, "item 4")
STEP = 0.05
SETTINGS = LinkSettings()


class Links:
    """Links of two vehicles, which forward what ``answer`` returns for each command: a MAV_RESULT, None: nothing."""

    def __init__(self, answer):
        self.answer, self.sent = answer, []
        self.links = [
            SimpleNamespace(
                requests=Requests(i + 1, {}, SETTINGS),
                status=SimpleNamespace(payload_text="Unloading denied: in the air"),
            )
            for i in range(2)
        ]

    def exchange(self, now):
        for link in self.links:
            for message in link.requests.due(now):
                assert (message.target_system, message.target_component) == (
                    px4.PAYLOAD_UNIT_SYSTEM, px4.PAYLOAD_UNIT_COMPONENT,
                )  # fmt: skip
                self.sent.append((link.requests, message.command, message.param1, message.param2, message.confirmation))
                result = self.answer(len(self.sent))
                if result is not None:
                    link.requests.take_payload_unit_acknowledgement(
                        mavlink.MAVLink_command_ack_message(message.command, result)
                    )


def carried_out(legs, answer=lambda number: mavlink.MAV_RESULT_ACCEPTED, until=20.0):
    """Return the legs after they were carried out, how long that took (s), and the links."""
    team, cargo = Links(answer), CargoState(SystemConfig())
    sequence = GroundLegs(team, 0.0, iter(legs), cargo)
    steps = 0
    while not sequence.done:
        assert steps * STEP < until
        sequence.step(steps * STEP, 100.0 + steps * STEP)
        team.exchange(100.0 + steps * STEP)
        steps += 1
    return sequence, (steps - 1) * STEP, team, cargo


def test_legs_are_carried_out_one_after_the_other():
    legs = [Stand(HERE, 1.0, "item 3"), RELEASE, Stand(HERE, 2.0, "item 5")]
    sequence, duration, team, cargo = carried_out(legs)
    assert duration == pytest.approx(3.0, abs=3 * STEP)
    assert team.sent == [(team.links[0].requests, mavlink.MAV_CMD_DO_GRIPPER, 1.0, 0.0, 0)]
    assert cargo.held == {2} and sequence.moved == {1} and not sequence.refusals


def test_command_goes_through_the_next_vehicle_until_it_is_answered():
    sequence, duration, team, cargo = carried_out([RELEASE], lambda number: 0 if number == 3 else None)
    first, second = (link.requests for link in team.links)
    assert [sent[0] for sent in team.sent] == [first, second, first] and [sent[4] for sent in team.sent] == [0, 1, 2]
    assert duration == pytest.approx(2 * SETTINGS.retry_interval, abs=2 * STEP)
    assert cargo.held == {2} and not sequence.refusals


def test_command_that_is_denied_leaves_the_cargo_and_has_its_reason():
    sequence, _, team, cargo = carried_out([RELEASE, Stand(HERE, 1.0, "")], lambda number: mavlink.MAV_RESULT_DENIED)
    assert len(team.sent) == 1 and cargo.held == {1, 2} and not sequence.moved
    answer = "the payload unit answers MAV_CMD_DO_GRIPPER with denied (Unloading denied: in the air)"
    assert sequence.refusals == [f"unloading of gripper 1: {answer}"]


def test_command_that_is_not_answered_may_have_been_carried_out():
    sequence, _, team, cargo = carried_out([RELEASE], lambda number: None)
    assert len(team.sent) == SETTINGS.tries
    assert sequence.refusals == ["unloading of gripper 1: the payload unit does not answer MAV_CMD_DO_GRIPPER"]
    assert cargo.held == {2} and sequence.moved == {1}


def test_answer_to_an_earlier_command_is_none_to_the_next():
    answers = [mavlink.MAV_RESULT_DENIED, None, mavlink.MAV_RESULT_ACCEPTED]
    sequence, *_ = carried_out([RELEASE, RELEASE], lambda number: answers[number - 1])
    assert len(sequence.refusals) == 1 and sequence.moved == {1}


def test_mission_is_taken_flight_by_flight(tmp_path):
    mission = read(
        tmp_path, plan(row(211, 2, 0), TAKE_OFF, A, row(21, alt=0), row(93, 5), TAKE_OFF, RETURN, row(211, 1, 0))
    )
    legs = MissionLegs.of(mission)
    assert not legs.takes_off and [leg.gripper for leg in legs.on_ground()] == [2]
    first = list(legs.flight())
    assert isinstance(first[0], TakeOff) and isinstance(first[-1], Land) and not legs.ended
    assert [leg.seconds for leg in legs.on_ground()] == [5.0] and legs.takes_off
    assert [type(leg).__name__ for leg in legs.flight()] == ["TakeOff", "FlyTo", "Land"]
    assert not legs.takes_off and not legs.ended and [leg.gripper for leg in legs.on_ground()] == [1]
    assert legs.ended


def test_curve_is_flown_once():
    legs = MissionLegs.of(read_mission("figure_eight"))
    assert legs.takes_off and not legs.ended
    assert [type(leg).__name__ for leg in legs.flight()] == ["TakeOff", "Curve"]
    assert legs.ended and not legs.takes_off
