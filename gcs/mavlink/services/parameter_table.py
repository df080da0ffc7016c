"""The parameters of an aircraft: values, limits, and what was saved."""

import math
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from zlib import crc32

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.errors import GcsError
from gcs.mavlink import px4
from gcs.mavlink.newer_messages import PARAM_ERROR_TYPE_MISMATCH

REAL: int = mavlink.MAV_PARAM_TYPE_REAL32
INTEGER: int = mavlink.MAV_PARAM_TYPE_INT32


class ParameterRefusalError(GcsError):
    """A parameter that does not exist or may not take the value; ``str`` says why, ``number`` is MAV_PARAM_ERROR."""

    def __init__(self, text: str, number: int) -> None:
        super().__init__(text)
        self.number = number


@dataclass
class Parameter:
    """One parameter. ``limits`` None: the ground may read it only; ``values``: those of the limits that it may take."""

    name: str
    value: float
    type: int = REAL
    limits: tuple[float, float] | None = None
    meaning: str = ""
    """What it does, in a few words."""
    values: tuple[float, ...] = ()
    default: float = field(init=False)
    saved: float = field(init=False)

    def __post_init__(self) -> None:
        if self.type == REAL:
            self.value = _float32(self.value)  # what is read back is what is used
        self.default = self.saved = self.value

    def check(self, value: float) -> None:
        """Raise :class:`ParameterRefusalError` for a value that it may not take."""
        if self.limits is None:
            raise ParameterRefusalError(f"{self.name}: read-only", mavlink.MAV_PARAM_ERROR_READ_ONLY)
        low, high = self.limits
        if not low <= value <= high:  # NaN, too
            raise ParameterRefusalError(
                f"{self.name}: {value:g} is outside {low:g} .. {high:g}", mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
            )
        if self.values and value not in self.values:
            allowed = ", ".join(f"{x:g}" for x in self.values)
            raise ParameterRefusalError(
                f"{self.name}: {value:g} is none of {allowed}", mavlink.MAV_PARAM_ERROR_VALUE_OUT_OF_RANGE
            )


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

    def __iter__(self) -> Iterator[Parameter]:
        return iter(self._parameters)

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
            raise ParameterRefusalError(f"{name}: no such parameter", mavlink.MAV_PARAM_ERROR_DOES_NOT_EXIST)
        if parameter.limits is not None and parameter_type != parameter.type:
            raise ParameterRefusalError(
                f"{name}: sent as type {parameter_type}, is of type {parameter.type}", PARAM_ERROR_TYPE_MISMATCH
            )
        value = px4.parameter_from_wire(wire, parameter.type)
        parameter.check(value)
        parameter.value = value

    def save(self) -> None:
        """Keep all values for :meth:`restore`."""
        for parameter in self._parameters:
            parameter.saved = parameter.value

    def restore(self) -> None:
        """Give all parameters the values that were saved last, the defaults if none were."""
        for parameter in self._parameters:
            parameter.value = parameter.saved

    def reset(self) -> None:
        """Give all parameters their defaults."""
        for parameter in self._parameters:
            parameter.value = parameter.default

    @property
    def checksum(self) -> int:
        """PX4's hash of all names and values: a CRC-32 without its inversions."""
        state = 0
        for parameter in self._parameters:
            value = struct.pack("<f" if parameter.type == REAL else "<i", _number(parameter))
            state = crc32(parameter.name.encode() + value, state ^ 0xFFFFFFFF) ^ 0xFFFFFFFF
        return state


def _number(parameter: Parameter) -> float | int:
    return parameter.value if parameter.type == REAL else int(parameter.value)


def _float32(value: float) -> float:
    number: float = struct.unpack("<f", struct.pack("<f", value))[0]
    if not math.isfinite(number):
        raise ValueError(f"{value} cannot be a parameter")
    return number
