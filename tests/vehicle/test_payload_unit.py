"""Grippers of the payload unit: their commands as the vehicles forward them, and the payload's mass in the world."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import pybullet
import pymavlink.dialects.v20.ardupilotmega as mavlink
import pytest
from scripted_ground import GROUND, ScriptedGround, exchange
from vehicle_bench import ACCEPTED, DENIED, PAYLOAD_UNIT, UNSUPPORTED

from gcs.config import SystemConfig
from gcs.config.tables import Cargo
from gcs.mavlink.codec import Codec
from gcs.mission.model import Fault
from gcs.record.reader import read_table
from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.swarm import Swarm
from vehicle_sim.world.truth_log import TruthLog

CARGO = Cargo(1, 0.5), Cargo(2, 0.8), Cargo(4, 0.3, loaded=False)
CONFIG = replace(SystemConfig(), cargo=CARGO)
M_0 = CONFIG.payload.mass
RELEASE, GRAB = mavlink.GRIPPER_ACTION_RELEASE, mavlink.GRIPPER_ACTION_GRAB
STRANGER = ("10.0.0.66", 40002)


class Team:
    """A swarm on the ground, and grounds that command its payload unit."""

    def __init__(self, swarm: Swarm, now: float = 0.5) -> None:
        self.swarm, self.now, self.codecs, self.reader = swarm, now, {}, Codec(254, 1)
        self.texts: list[str] = []
        swarm.advance_to(now)

    @property
    def mass(self) -> float:
        return self.swarm.world.payload_mass

    def command(self, number: int, *parameters: float, vehicle: int = 1, sender: Any = GROUND) -> Any:
        """Send a command to the payload unit by a vehicle, and return the acknowledgement."""
        values = [*parameters, *([0.0] * (7 - len(parameters)))]
        message = mavlink.MAVLink_command_long_message(*PAYLOAD_UNIT, number, 0, *values)
        codec = self.codecs.setdefault((sender, vehicle), Codec(255, 190))
        for each in (mavlink.MAVLink_mission_ack_message(vehicle, 1, 0), message):
            self.swarm.receive(vehicle, codec.encode(each), sender, self.now)
        answers = [
            received.message
            for _, datagram, address in self.swarm.datagrams_to_send(self.now) if address == sender
            for received in self.reader.decode(datagram)
            if received.message.get_type() in ("COMMAND_ACK", "STATUSTEXT")
        ]  # fmt: skip
        assert {(m.get_srcSystem(), m.get_srcComponent()) for m in answers} == {PAYLOAD_UNIT}
        self.texts = ["".join(m.text for m in answers if m.get_type() == "STATUSTEXT")]
        [ack] = [m for m in answers if m.get_type() == "COMMAND_ACK"]
        assert ack.command == number
        return ack

    def gripper(self, gripper: float, action: float, **options: Any) -> int:
        return self.command(mavlink.MAV_CMD_DO_GRIPPER, gripper, action, **options).result

    def winch(self, gripper: float, action: float) -> int:
        return self.command(mavlink.MAV_CMD_DO_WINCH, gripper, action).result


@pytest.fixture
def team(tmp_path):
    with Swarm(CONFIG, seed=1) as swarm:
        swarm.record(TruthLog(tmp_path, 4))
        yield Team(swarm)


def actions(folder):
    table = read_table(folder / "cargo.csv")
    return [tuple(row) for row in table[["gripper", "action", "mass_kg", "payload_mass_kg"]].tolist()]


def engine_mass(swarm: Swarm) -> tuple[float, float]:
    """Return mass (kg) and inertia (kg m2) about north of the payload in the engine."""
    world = swarm.world
    mass, _, inertia, *_ = pybullet.getDynamicsInfo(world._system.body, -1, world._client)
    return mass, inertia[0]


def test_gripper_releases_and_grabs_on_the_ground(team, tmp_path):
    inertia = engine_mass(team.swarm)[1]
    assert team.gripper(2, RELEASE) == ACCEPTED and team.mass == pytest.approx(M_0 - 0.8)
    assert engine_mass(team.swarm) == pytest.approx((M_0 - 0.8, inertia * (M_0 - 0.8) / M_0))
    assert team.gripper(4, GRAB) == ACCEPTED and team.mass == pytest.approx(M_0 - 0.8 + 0.3)
    assert team.gripper(2, RELEASE, vehicle=3) == ACCEPTED  # holds nothing: as in PX4
    assert team.winch(2, mavlink.WINCH_LOAD_PAYLOAD) == ACCEPTED
    assert team.winch(0, mavlink.WINCH_DELIVER) == ACCEPTED and team.mass == pytest.approx(M_0 - 1.3)
    team.swarm.close()
    assert [row[:3] for row in actions(tmp_path)] == [
        (2, "release", 0.8), (4, "grab", 0.3), (2, "grab", 0.8),
        (1, "release", 0.5), (2, "release", 0.8), (4, "release", 0.3),
    ]  # fmt: skip
    assert actions(tmp_path)[-1][3] == pytest.approx(M_0 - 1.3)


def test_command_forwarded_by_all_vehicles_acts_once(team, tmp_path):
    assert [team.gripper(1, RELEASE, vehicle=vehicle) for vehicle in (1, 2)] == [ACCEPTED] * 2
    assert team.gripper(1, GRAB, vehicle=1) == ACCEPTED
    # Copies that are late neither release again what was grabbed since, nor remain unanswered.
    assert [team.gripper(1, RELEASE, vehicle=vehicle) for vehicle in (3, 4)] == [ACCEPTED] * 2
    assert team.mass == pytest.approx(M_0)
    assert team.gripper(1, RELEASE, vehicle=1) == ACCEPTED and team.mass == pytest.approx(M_0 - 0.5)
    team.swarm.close()
    assert [row[:2] for row in actions(tmp_path)] == [(1, "release"), (1, "grab"), (1, "release")]


@pytest.mark.parametrize(
    ("number", "parameters", "result", "parameter", "text"),
    [
        (mavlink.MAV_CMD_DO_GRIPPER, (3, RELEASE), DENIED, 1, "no gripper 3, the payload has grippers 1, 2, 4"),
        (mavlink.MAV_CMD_DO_GRIPPER, (math.nan, RELEASE), DENIED, 1, "no gripper nan"),
        (mavlink.MAV_CMD_DO_GRIPPER, (1.5, GRAB), DENIED, 1, "Loading denied: no gripper 1.5"),
        (mavlink.MAV_CMD_DO_GRIPPER, (1, 2), DENIED, 2, "action 2 is neither release (0) nor grab (1)"),
        (mavlink.MAV_CMD_DO_WINCH, (1, mavlink.WINCH_RELATIVE_LENGTH_CONTROL), UNSUPPORTED, 0, ""),
        (mavlink.MAV_CMD_DO_SET_SERVO, (1, 1000), UNSUPPORTED, 0, ""),
    ],
)
def test_payload_unit_denies_what_it_cannot_do_with_the_reason(team, number, parameters, result, parameter, text):
    ack = team.command(number, *parameters)
    assert (ack.result, ack.result_param2) == (result, parameter) and text in team.texts[0]
    assert team.mass == M_0


def test_payload_without_grippers_says_so():
    with Swarm(replace(SystemConfig(), cargo=()), seed=1) as swarm:
        team = Team(swarm)
        assert team.gripper(0, RELEASE) == DENIED and "the payload has no gripper" in team.texts[0]


def test_unloading_is_denied_while_armed_in_the_air_and_to_strangers():
    system = CONFIG.parameters()
    ground = ScriptedGround([("uav", i) for i in (1, 2, 3, 4)], float(system.hover_thrust.mean()), system.thrust_max)
    stuck = Fault("gripper_stuck", 0.0, settings={"gripper": 2})
    with Swarm(CONFIG, seed=1, faults=FaultInjector((stuck,), 1, CONFIG)) as swarm:
        armed = exchange(swarm, ground, 0.6)
        team = Team(swarm, armed)
        assert swarm.vehicles[0].autopilot.armed
        assert team.gripper(1, RELEASE) == DENIED and "Unloading denied: rotors are not stopped" in team.texts[0]
        assert team.gripper(1, RELEASE, sender=STRANGER) == DENIED
        assert "another ground station is in control" in team.texts[0]
        team.now = exchange(swarm, ground, 10.0, lambda: ground.finished)
        assert team.gripper(1, RELEASE) == DENIED and "Unloading denied: in the air" in team.texts[0]
        assert team.gripper(4, GRAB) == DENIED and "Loading denied: in the air" in team.texts[0]
        team.now = exchange(swarm, ground, 60.0, lambda: swarm.at_rest)
        assert swarm.at_rest and team.mass == M_0
        # Landed, and nobody is in control any more; gripper 2 is stuck since take-off.
        assert team.gripper(0, RELEASE, sender=STRANGER) == ACCEPTED
        assert team.mass == pytest.approx(M_0 - 0.5)


def test_mass_factor_of_the_world_holds_for_the_cargo_and_faults_add_to_it():
    heavier = replace(CONFIG, world=replace(CONFIG.world, payload_mass_factor=1.2))
    with Swarm(heavier, seed=1) as swarm:
        team = Team(swarm)
        swarm.world.add_payload_mass("faults", 0.25)
        assert team.gripper(1, RELEASE) == ACCEPTED
        assert team.mass == pytest.approx(1.2 * (M_0 - 0.5) + 0.25)
        swarm.world.add_payload_mass("faults", -100.0)
        assert 0.0 < team.mass < 0.2
