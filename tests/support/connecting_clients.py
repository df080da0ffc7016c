"""Ground stations that connect to an aircraft as theirs do, in simulated time: every request is sent once.

QGroundControl: the states of ``InitialConnectStateMachine.cc``, each of which repeats its request at a timeout. MAVROS:
what its plugins ask when a vehicle's HEARTBEAT has come; it has the vehicle's own system id.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as m
from vehicle_bench import ACCEPTED, GROUND, UNSUPPORTED, Bench, command

from gcs.mavlink import newer_messages
from gcs.mavlink.services.mission_item import PlanType

STEP = 0.02
"""Time (s) between two looks at what has come."""
RETRY = 1.0
"""Time (s) after which the most impatient of them, a plugin of MAVROS, repeats a request."""
COMPONENT_METADATA, COMPONENT_INFORMATION = 397, 395

REQUIRED = {
    PlanType.MISSION: m.MAV_PROTOCOL_CAPABILITY_MISSION_INT,
    PlanType.FENCE: m.MAV_PROTOCOL_CAPABILITY_MISSION_FENCE,
    PlanType.RALLY: m.MAV_PROTOCOL_CAPABILITY_MISSION_RALLY,
}
"""The capability without which QGroundControl does not ask for a plan, or not for integer coordinates."""


class Client:
    """A system and component at an address; ``requests`` are those that were sent, ``slowest`` the longest wait (s)."""

    system, component = 255, 190

    def __init__(self, bench: Bench) -> None:
        self.bench = bench
        self.requests: list[Any] = []
        self.slowest = 0.0
        self._taken = 0

    @property
    def inbox(self) -> list[Any]:
        """What the vehicle has sent here, not what it forwards."""
        self.bench.collect()
        inbox = self.bench.inbox.setdefault(GROUND, [])
        return [found for found in inbox if (found.get_srcSystem(), found.get_srcComponent()) == self.bench.target]

    def tell(self, message: Any) -> None:
        """Send what draws no answer."""
        self.bench.send(message, GROUND, self.system, self.component)

    def draw(self, message: Any, kind: str, last: Callable[[Any], bool] = lambda found: True) -> list[Any]:
        """Send a request once; return the answers of a kind until the ``last`` of them, which comes in time."""
        self.requests.append(message)
        start, before = self.bench.now, len(self.inbox)
        self.tell(message)
        while self.bench.now - start < RETRY:
            answers = [found for found in self.inbox[before:] if found.get_type() == kind]
            if answers and last(answers[-1]):
                self.slowest = max(self.slowest, self.bench.now - start)
                return answers
            self.bench.run(STEP)
        raise AssertionError(f"{message.get_type()}: no {kind} in {RETRY} s")

    def command(self, number: int, *parameters: float) -> int:
        """Return the result of a command; its acknowledgement is for this client."""
        system, component = self.bench.target
        request = command(number, *parameters, system=system, component=component)
        [ack] = self.draw(request, "COMMAND_ACK")
        assert (ack.command, ack.target_system, ack.target_component) == (number, self.system, self.component)
        return int(ack.result)

    def message(self, number: int, kind: str, parameter: float = 0.0) -> list[Any]:
        """Return what REQUEST_MESSAGE draws; it is acknowledged, too."""
        before = len(self.inbox)
        assert self.command(m.MAV_CMD_REQUEST_MESSAGE, number, parameter) == ACCEPTED
        return [found for found in self.inbox[before:] if found.get_type() == kind]

    def parameters(self, component: int) -> dict[str, float]:
        """Return all parameters: none is missing, so that none is asked for by its index."""
        list_all = m.MAVLink_param_request_list_message(self.bench.target[0], component)
        values = self.draw(list_all, "PARAM_VALUE", lambda found: found.param_index == found.param_count - 1)
        check, *values = values
        assert check.param_id == "_HASH_CHECK"
        assert [found.param_index for found in values] == list(range(values[0].param_count))
        return {found.param_id: found.param_value for found in values} | {"_HASH_CHECK": check.param_value}

    def plan(self, plan_type: PlanType) -> list[Any]:
        """Return the items of a plan, each requested in its turn, and acknowledge them."""
        [found] = self.draw(m.MAVLink_mission_request_list_message(*self.bench.target, plan_type), "MISSION_COUNT")
        assert found.mission_type == plan_type
        items = []
        for number in range(found.count):
            request = m.MAVLink_mission_request_int_message(*self.bench.target, number, plan_type)
            [item] = self.draw(request, "MISSION_ITEM_INT")
            assert (item.seq, item.mission_type) == (number, plan_type)
            items.append(item)
        self.tell(m.MAVLink_mission_ack_message(*self.bench.target, m.MAV_MISSION_ACCEPTED, plan_type))
        return items

    def has_heard_heartbeat(self) -> bool:
        """Whether the vehicle has shown itself: nothing is asked before."""
        return any(found.get_type() == "HEARTBEAT" and found.autopilot == m.MAV_AUTOPILOT_PX4 for found in self.inbox)


class QGroundControl(Client):
    """Its connect states, in their order."""

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.capabilities = 0
        self.modes: list[Any] = []
        self.values: dict[str, float] = {}
        self.tell(m.MAVLink_heartbeat_message(m.MAV_TYPE_GCS, m.MAV_AUTOPILOT_INVALID, 0, 0, m.MAV_STATE_ACTIVE, 3))

    def connect(self) -> dict[PlanType, list[Any]]:
        """Go through all states; return the plans."""
        self.ask_version()
        self.ask_modes()
        self.ask_component_information()
        self.ask_parameters()
        return self.ask_plans()

    def ask_version(self) -> None:
        [version] = self.message(m.MAVLINK_MSG_ID_AUTOPILOT_VERSION, "AUTOPILOT_VERSION")
        self.capabilities = version.capabilities

    def ask_modes(self) -> None:
        self.modes = self.message(newer_messages.AVAILABLE_MODES, "AVAILABLE_MODES")
        assert [mode.mode_index for mode in self.modes] == list(range(1, self.modes[0].number_modes + 1))

    def ask_component_information(self) -> None:
        """Both are refused at once: there is no file to be read by FTP then."""
        for number in (COMPONENT_METADATA, COMPONENT_INFORMATION):
            assert self.command(m.MAV_CMD_REQUEST_MESSAGE, number) == UNSUPPORTED

    def ask_parameters(self) -> None:
        """Load all; if the hash is that of values which it has kept, say so, and use those."""
        read = self.parameters(m.MAV_COMP_ID_ALL)
        if read["_HASH_CHECK"] == self.values.get("_HASH_CHECK"):
            kind = m.MAV_PARAM_TYPE_UINT32
            self.tell(m.MAVLink_param_set_message(*self.bench.target, b"_HASH_CHECK", read["_HASH_CHECK"], kind))
        self.values = read

    def ask_plans(self) -> dict[PlanType, list[Any]]:
        for plan_type, capability in REQUIRED.items():
            assert self.capabilities & capability, plan_type
        return {plan_type: self.plan(plan_type) for plan_type in REQUIRED}


class Mavros(Client):
    """A companion with the vehicle's own system id; its plugins ask one after the other."""

    system, component = 1, 191

    def __init__(self, bench: Bench) -> None:
        super().__init__(bench)
        self.synchronised: list[tuple[int, int]] = []
        """Time (ns) of each TIMESYNC that was sent, and the vehicle's in the answer."""

    def connect(self) -> dict[PlanType, list[Any]]:
        """Do what follows the vehicle's first HEARTBEAT; return the plans."""
        # The first request of the version is to all systems, and no acknowledgement is waited for.
        everyone = command(m.MAV_CMD_REQUEST_AUTOPILOT_CAPABILITIES, 1.0, system=0, component=0)
        [version] = self.draw(everyone, "AUTOPILOT_VERSION")
        assert version.capabilities & m.MAV_PROTOCOL_CAPABILITY_MISSION_INT
        self.values = self.parameters(1)
        plans = {plan_type: self.plan(plan_type) for plan_type in PlanType}
        assert self.command(m.MAV_CMD_GET_HOME_POSITION) == ACCEPTED
        return plans

    def stay(self, seconds: float) -> None:
        """Let time pass with the messages of its timers: HEARTBEAT, SYSTEM_TIME (1 Hz) and TIMESYNC (10 Hz)."""
        beat = m.MAVLink_heartbeat_message(m.MAV_TYPE_ONBOARD_CONTROLLER, m.MAV_AUTOPILOT_INVALID, 192, 0, 4, 3)
        for k in range(round(10 * seconds)):
            if k % 10 == 0:
                self.tell(beat)
                self.tell(m.MAVLink_system_time_message(1_700_000_000_000_000 + 100_000 * k, 0))
            sent = round(1e9 * self.bench.now) + 1
            [answer] = self.draw(m.MAVLink_timesync_message(0, sent), "TIMESYNC")
            assert answer.ts1 == sent
            self.synchronised.append((sent, answer.tc1))
            self.bench.run(0.1)
