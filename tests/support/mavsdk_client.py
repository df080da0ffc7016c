"""A client program on MAVSDK 4: one connection to one vehicle, with its plugins."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import AsyncGenerator, Callable, Coroutine
from typing import Any

from client_swarm import ClientSwarm, Track
from mavsdk.asyncio import Configuration, Mavsdk
from mavsdk.asyncio.plugins.action import ActionAsync
from mavsdk.asyncio.plugins.mission import MissionAsync
from mavsdk.asyncio.plugins.mission_raw import MissionRawAsync
from mavsdk.asyncio.plugins.offboard import OffboardAsync
from mavsdk.asyncio.plugins.param import ParamAsync
from mavsdk.asyncio.plugins.telemetry import TelemetryAsync
from mavsdk.component_type import ComponentType
from programs import PATIENCE

Program = Callable[["Client"], Coroutine[Any, Any, Any]]


class Client:
    """The plugins of one vehicle."""

    def __init__(self, mavsdk: Any, system: Any) -> None:
        self.mavsdk, self.system = mavsdk, system
        self.action, self.offboard = ActionAsync(system), OffboardAsync(system)
        self.telemetry, self.param = TelemetryAsync(system), ParamAsync(system)
        self.mission, self.mission_raw = MissionAsync(system), MissionRawAsync(system)

    async def height_is(self, height: float, tolerance: float = 0.15) -> None:
        """Wait for a message with this height above home (m)."""
        await first(self.telemetry.subscribe_position(), lambda p: abs(p.relative_altitude_m - height) < tolerance)

    async def is_at(self, north: float, east: float, down: float, tolerance: float = 0.2) -> None:
        """Wait for a message with this local position (m)."""

        def near(found: Any) -> bool:
            p = found.position
            return max(abs(p.north_m - north), abs(p.east_m - east), abs(p.down_m - down)) < tolerance

        await first(self.telemetry.subscribe_position_velocity_ned(), near)

    async def take_off(self, height: float = 2.0) -> None:
        """Arm, take off, and wait until it holds there."""
        await self.action.set_takeoff_altitude(height)
        await self.action.arm()
        await self.action.takeoff()
        await self.height_is(height)

    async def land(self) -> None:
        """Land, and wait until it has disarmed."""
        await self.action.land()
        await self.disarmed()

    async def disarmed(self) -> None:
        """Wait until it is disarmed, and its rotors stand."""
        await first(self.telemetry.subscribe_armed(), lambda armed: not armed)
        output = await second(self.telemetry.subscribe_actuator_output_status())  # they come once a second
        assert not output.active and not any(output.actuator)


async def first(messages: AsyncGenerator[Any], wanted: Callable[[Any], bool] = lambda _: True) -> Any:
    """Return the first of these messages that is wanted."""
    async with contextlib.aclosing(messages):
        async for message in messages:
            if wanted(message):
                return message
    raise AssertionError("the stream ended")


async def second(messages: AsyncGenerator[Any]) -> Any:
    """Return the second of these messages: between both an interval has passed."""
    async with contextlib.aclosing(messages):
        await anext(messages)
        return await anext(messages)


def fly(port: int, program: Program) -> Any:
    """Run a program with a client of the vehicle that sends to a port, and return what it returns."""
    return asyncio.run(_connected(port, program))


def together(programs: dict[int, Program]) -> None:
    """Run programs at the same time, each with a client of the vehicle that sends to its port."""

    async def all_of_them() -> None:
        await asyncio.gather(*(_connected(port, program) for port, program in programs.items()))

    asyncio.run(all_of_them())


async def _connected(port: int, program: Program) -> Any:
    configuration = Configuration.create_with_component_type(ComponentType.GROUND_STATION)
    async with Mavsdk(configuration) as mavsdk:
        await mavsdk.add_any_connection(f"udpin://127.0.0.1:{port}")
        system = await mavsdk.first_autopilot(timeout_s=PATIENCE)
        assert system is not None, "no vehicle was found"
        return await asyncio.wait_for(program(Client(mavsdk, system)), PATIENCE)


class Steps:
    """What a client did one after the other, each with the time of the records in which it was done."""

    def __init__(self, swarm: ClientSwarm) -> None:
        self.swarm = swarm
        self.results: dict[str, Any] = {}
        self._times: dict[str, tuple[float, float]] = {}

    async def __call__(self, name: str, *actions: Coroutine[Any, Any, Any]) -> None:
        """Carry out actions, the last of which waits for what they bring about."""
        began = self.swarm.now()
        for action in actions:
            self.results[name] = await action
        self._times[name] = began, self.swarm.now()

    def track(self, name: str, vehicle: int = 1) -> Track:
        """Return what a vehicle truly did during a step."""
        return self.swarm.track(vehicle, *self._times[name])

    def modes(self, name: str, vehicle: int = 1) -> list[str]:
        """Return the modes that a vehicle entered during a step."""
        return self.swarm.modes(vehicle, *self._times[name])

    def armed(self, name: str, vehicle: int = 1) -> list[bool]:
        """Return whether a vehicle was armed or disarmed during a step."""
        return self.swarm.armed(vehicle, *self._times[name])
