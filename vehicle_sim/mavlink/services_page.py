"""``docs/services.md``, written from the code: ``python -m vehicle_sim.mavlink.services_page`` prints it."""

import inspect
from collections.abc import Callable
from functools import partial
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config import SystemConfig
from gcs.mavlink import px4
from gcs.mavlink.layout import LAYOUTS
from gcs.mavlink.services.parameter_table import REAL, Parameter
from vehicle_sim.autopilot.airframe import Airframe
from vehicle_sim.autopilot.free.parameters import free_parameters
from vehicle_sim.mavlink.streams import CLIENT_STREAMS, default_intervals
from vehicle_sim.mavlink.vehicle import Vehicle


def services_page() -> str:
    """Return the whole page, of a vehicle on the payload of the default system."""
    config = SystemConfig()
    vehicle = Vehicle(1, Airframe.of_system(config.true_parameters(), 0, config.uav), link=config.vehicle_link)
    intervals = default_intervals(config.vehicle_link.intervals, 1.0 / config.rates.telemetry)
    messages = "\n".join(
        f"| {number} | {LAYOUTS[number].kind.msgname} | {_interval(intervals.get((component, number)))}"
        f"{' *' if (component, number) in CLIENT_STREAMS else ''} | {_meaning(build)} |"
        for (component, number), build in sorted(vehicle.telemetry.builders.items())
        if component == px4.AUTOPILOT_COMPONENT
    )
    commands = "\n".join(
        f"| {number} | {mavlink.enums['MAV_CMD'][number].name} | {_meaning(run)} |"
        for number, run in sorted(vehicle.dispatcher.commands.items())
    )
    modes = "\n".join(
        f"| {px4.MODE_LABELS[mode]} | `{px4.mode_name(mode)}` | {mode} | {_standard_mode(mode)} |"
        for mode in vehicle.aircraft.modes
    )
    parameters = "\n".join(_row(parameter) for parameter in vehicle.parameters)
    airframe = Airframe.of_config(config.uav)
    free = Vehicle(1, airframe, link=config.vehicle_link, free=True)
    free_modes = ", ".join(f"`{px4.mode_name(mode)}`" for mode in free.aircraft.modes)
    own = {parameter.name for parameter in free_parameters(airframe)}
    of_free = "\n".join(_row(parameter) for parameter in free.parameters if parameter.name in own)
    return f"""# MAVLink services of a vehicle

This page is made from the code: `make docs`. It is of a vehicle that carries a payload with others, with the default
settings; how clients connect is in [clients.md](clients.md).

## Messages

Intervals are those of each link until its client sets others (MAV_CMD_SET_MESSAGE_INTERVAL, down to
{config.vehicle_link.interval_min:g} s); every message comes once by MAV_CMD_REQUEST_MESSAGE. One of which there is no
data now is refused for now; one that this world does not have is refused with the reason. With an asterisk: streamed
unasked to the ports of clients only (14540 and on, 14550), to those who call in on request.

| id | message | interval | what |
|---|---|---|---|
{messages}

AVAILABLE_MODES comes on request only, with the number of a mode in param2, 0 for all. COMMAND_ACK, MESSAGE_INTERVAL,
PARAM_VALUE, PARAM_ERROR, STATUSTEXT (long texts in chunks), TIMESYNC, PING, LOG_ENTRY (there are no logs) and
FILE_TRANSFER_PROTOCOL (every file is refused) are answers.

## Commands

COMMAND_LONG and COMMAND_INT. What is accepted is done; a refusal has its reason as a STATUSTEXT, and in
`result_param2` the number of the parameter that is wrong. Everything else is MAV_RESULT_UNSUPPORTED, and so is every
command to another component of the vehicle. A command that is repeated (`confirmation`) after it was accepted is
answered, not done again. Places are in a global MAV_FRAME, above the sea or above home; in others they are
MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME. While a ground station flies the vehicle, others may only request
information. On a payload take-off, go-to, speed, missions and return of one vehicle are refused, and so is every
command to all systems (0) that is no request of information.

| number | command | what |
|---|---|---|
{commands}

COMMAND_CANCEL is answered with the result of the sender's last command: none is ever in progress.

## Modes

Those that it can enter, in the order of AVAILABLE_MODES.

| mode | name | `custom_mode` | standard mode |
|---|---|---|---|
{modes}

## Parameters

Integers are sent byte-wise, as by PX4. A refusal is a PARAM_ERROR, and of PARAM_SET the value that is kept follows.
MAV_CMD_PREFLIGHT_STORAGE saves, restores and resets them; what is saved is kept until `vehicle-sim` ends.
`_HASH_CHECK` is PX4's hash of all.

| parameter | type | default | range | what |
|---|---|---|---|---|
{parameters}

## Vehicles without a payload

With `vehicle-sim --free` messages and commands are the same; take-off, go-to, heading, speed, home, missions and return
are carried out, and a command to all systems is obeyed ([what is flown](clients.md#vehicles-without-a-payload)). Modes:
{free_modes}.

These parameters are added, or have other defaults:

| parameter | type | default | range | what |
|---|---|---|---|---|
{of_free}
"""


def _interval(interval: float | None) -> str:
    return "on request" if interval is None else f"{interval:g} s"


def _meaning(function: Callable[..., Any]) -> str:
    """Return the first line of a docstring, without its full stop."""
    if isinstance(function, partial):
        function = function.func
    return (inspect.getdoc(function) or "").split("\n")[0].removesuffix(".")


def _standard_mode(mode: int) -> str:
    standard = px4.standard_mode(mode)
    if standard == mavlink.MAV_STANDARD_MODE_NON_STANDARD:
        return ""
    name: str = mavlink.enums["MAV_STANDARD_MODE"][standard].name
    return f"{name} ({standard})"


def _row(parameter: Parameter) -> str:
    kind = "float" if parameter.type == REAL else "int32"
    if parameter.limits is None:
        allowed = "read-only"
    elif parameter.values:
        allowed = ", ".join(f"{value:g}" for value in parameter.values)
    else:
        low, high = parameter.limits
        allowed = f"{low:g}" if low == high else f"{low:g} .. {high:g}"
    return f"| `{parameter.name}` | {kind} | {parameter.default:g} | {allowed} | {parameter.meaning} |"


if __name__ == "__main__":
    print(services_page(), end="")
