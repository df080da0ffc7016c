"""The MAVLink parameter protocol, in PX4's byte-wise flavour, and the parameters that it serves."""

import math
import struct
from dataclasses import dataclass

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.errors import GcsError
from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Control
from gcs.mavlink.services.dispatcher import Dispatcher, Request

REAL: int = mavlink.MAV_PARAM_TYPE_REAL32
INTEGER: int = mavlink.MAV_PARAM_TYPE_INT32


class ParameterRefusalError(GcsError):
    """A parameter that does not exist or may not take the value; ``str`` says why."""


@dataclass
class Parameter:
    """One parameter. ``limits`` None: the ground may read it only."""

    name: str
    value: float
    type: int = REAL
    limits: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        if self.type == REAL:
            self.value = _float32(self.value)  # what is read back is what is used


class ParameterTable:
    """Parameters by name and by index, sorted by name as PX4 does."""

    def __init__(self, parameters: list[Parameter]) -> None:
        self._parameters = sorted(parameters, key=lambda parameter: parameter.name)
        self._by_name = {parameter.name: parameter for parameter in self._parameters}
        self._index = {parameter.name: i for i, parameter in enumerate(self._parameters)}
        if len(self._index) != len(self._parameters) or any(len(name) > 16 for name in self._index):
            raise ValueError("parameter names must be unique and at most 16 characters long")

    def __len__(self) -> int:
        return len(self._parameters)

    def __getitem__(self, name: str) -> float:
        return self._by_name[name].value

    def by_index(self, index: int) -> Parameter | None:
        """The parameter at an index of the list, None outside."""
        return self._parameters[index] if 0 <= index < len(self._parameters) else None

    def by_name(self, name: str) -> Parameter | None:
        """The parameter of a name, None if there is none."""
        return self._by_name.get(name)

    def index_of(self, name: str) -> int:
        """Position of an existing parameter in the list."""
        return self._index[name]

    def set_from_wire(self, name: str, wire: float, parameter_type: int) -> None:
        """Store what a PARAM_SET carries. Raises :class:`ParameterRefusalError` and then changes nothing."""
        parameter = self.by_name(name)
        if parameter is None:
            raise ParameterRefusalError(f"{name}: no such parameter")
        if parameter.limits is None:
            raise ParameterRefusalError(f"{name}: read-only")
        if parameter_type != parameter.type:
            raise ParameterRefusalError(f"{name}: sent as type {parameter_type}, is of type {parameter.type}")
        value = px4.parameter_from_wire(wire, parameter_type)
        low, high = parameter.limits
        if not low <= value <= high:  # NaN, too
            raise ParameterRefusalError(f"{name}: {value:g} is outside {low:g} .. {high:g}")
        parameter.value = value


class ParameterServer:
    """PARAM_REQUEST_READ, PARAM_REQUEST_LIST and PARAM_SET. A refused PARAM_SET is answered with the value kept."""

    def __init__(self, table: ParameterTable, control: Control) -> None:
        self._table = table
        self._control = control

    def register(self, dispatcher: Dispatcher) -> None:
        """Take the messages of this service."""
        dispatcher.register(mavlink.MAVLink_param_request_read_message, self._on_read)
        dispatcher.register(mavlink.MAVLink_param_request_list_message, self._on_list)
        dispatcher.register(mavlink.MAVLink_param_set_message, self._on_set)

    def _on_read(self, message: mavlink.MAVLink_param_request_read_message, request: Request) -> None:
        if message.param_index >= 0:
            self._send(self._table.by_index(message.param_index), request)
        else:
            self._send(self._table.by_name(message.param_id), request)

    def _on_list(self, message: mavlink.MAVLink_param_request_list_message, request: Request) -> None:
        for index in range(len(self._table)):
            self._send(self._table.by_index(index), request)

    def _on_set(self, message: mavlink.MAVLink_param_set_message, request: Request) -> None:
        name = message.param_id
        if self._control.is_stranger(request.sender, request.now):
            request.peer.send_statustext(f"{name} denied: another ground is in control")
        else:
            try:
                self._table.set_from_wire(name, message.param_value, message.param_type)
            except ParameterRefusalError as error:
                request.peer.send_statustext(str(error))
        self._send(self._table.by_name(name), request)

    def _send(self, parameter: Parameter | None, request: Request) -> None:
        """Send the value of a parameter; nothing of one that does not exist."""
        if parameter is None:
            return
        value = px4.parameter_to_wire(parameter.value, parameter.type)
        count, index = len(self._table), self._table.index_of(parameter.name)
        request.peer.reply(
            mavlink.MAVLink_param_value_message(parameter.name.encode(), value, parameter.type, count, index)
        )


def _float32(value: float) -> float:
    number: float = struct.unpack("<f", struct.pack("<f", value))[0]
    if not math.isfinite(number):
        raise ValueError(f"{value} cannot be a parameter")
    return number
