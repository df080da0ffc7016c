"""Messages of MAVLink's common set that the dialect of the installed pymavlink lacks, as classes like its own.

Numbers and fields are those of ``common.xml``; checksums and layouts follow from them.
"""

import struct
from itertools import count
from typing import Any

import pymavlink.dialects.v20.ardupilotmega as mavlink

PROTOCOL_VERSION = 300
AVAILABLE_MODES = 435
CURRENT_MODE = 436
AVAILABLE_MODES_MONITOR = 437
COMMAND_CANCEL = 80

#: Values of enumerations that the dialect lacks.
RESULT_UNSUPPORTED_FRAME = 9  #: MAV_RESULT_COMMAND_UNSUPPORTED_MAV_FRAME
PARAM_ERROR_TYPE_MISMATCH = 7  #: MAV_PARAM_ERROR_TYPE_MISMATCH
MODE_PROPERTY_ADVANCED = 1  #: MAV_MODE_PROPERTY_ADVANCED
MODE_PROPERTY_NOT_SELECTABLE = 2  #: MAV_MODE_PROPERTY_NOT_USER_SELECTABLE

_CODES = {"uint8_t": "B", "uint16_t": "H", "uint32_t": "I", "char": "c"}
_DEFINITIONS: dict[int, tuple[str, tuple[tuple[str, str, int], ...]]] = {
    COMMAND_CANCEL: (
        "COMMAND_CANCEL",
        (("uint8_t", "target_system", 0), ("uint8_t", "target_component", 0), ("uint16_t", "command", 0)),
    ),
    PROTOCOL_VERSION: (
        "PROTOCOL_VERSION",
        (
            ("uint16_t", "version", 0), ("uint16_t", "min_version", 0), ("uint16_t", "max_version", 0),
            ("uint8_t", "spec_version_hash", 8), ("uint8_t", "library_version_hash", 8),
        ),
    ),
    AVAILABLE_MODES: (
        "AVAILABLE_MODES",
        (
            ("uint8_t", "number_modes", 0), ("uint8_t", "mode_index", 0), ("uint8_t", "standard_mode", 0),
            ("uint32_t", "custom_mode", 0), ("uint32_t", "properties", 0), ("char", "mode_name", 35),
        ),
    ),
    CURRENT_MODE: (
        "CURRENT_MODE",
        (("uint8_t", "standard_mode", 0), ("uint32_t", "custom_mode", 0), ("uint32_t", "intended_custom_mode", 0)),
    ),
    AVAILABLE_MODES_MONITOR: ("AVAILABLE_MODES_MONITOR", (("uint8_t", "seq", 0),)),
}  # fmt: skip
"""Name and fields of each message: type, name, and length of an array (0: none)."""


class NewerMessage(mavlink.MAVLink_message):
    """A message that the dialect lacks; its fields are attributes."""

    def __init__(self, *values: Any) -> None:
        """``values`` of the fields, in the order of the definition."""
        super().__init__(self.id, self.msgname)
        self._fieldnames = self.fieldnames
        self._instance_field, self._instance_offset = None, -1
        for name, value in zip(self.fieldnames, values, strict=True):
            if isinstance(value, bytes):
                setattr(self, f"_{name}_raw", value)
                value = value.split(b"\0", 1)[0].decode("ascii", "replace")
            setattr(self, name, value)


def _class_of(number: int, name: str, fields: tuple[tuple[str, str, int], ...]) -> type[NewerMessage]:
    """Return the class of a message, with the attributes of pymavlink's."""
    # The wire has the fields by falling size of their elements, of equal ones in the order of the definition.
    wire = sorted(fields, key=lambda field: -struct.calcsize(_CODES[field[0]]))
    checksum = mavlink.x25crc(f"{name} ".encode())
    for kind, field, length in wire:
        checksum.accumulate(f"{kind} {field} ".encode())
        if length:
            checksum.accumulate(bytes([length]))
    places = dict(zip([field for _, field, _ in wire], count(), strict=False))
    codes = [f"{length}s" if kind == "char" else f"{length or ''}{_CODES[kind]}" for kind, _, length in wire]
    attributes = {
        "id": number,
        "msgname": name,
        "fieldnames": [field for _, field, _ in fields],
        "ordered_fieldnames": [field for _, field, _ in wire],
        "fieldtypes": [kind for kind, _, _ in fields],
        "fielddisplays_by_name": {},
        "fieldenums_by_name": {},
        "fieldunits_by_name": {},
        "native_format": bytearray(("<" + "".join(_CODES[kind] for kind, _, _ in wire)).encode()),
        "orders": [places[field] for _, field, _ in fields],
        "lengths": [1 if kind == "char" else length or 1 for kind, _, length in wire],
        "array_lengths": [length for _, _, length in wire],
        "crc_extra": (checksum.crc & 0xFF) ^ (checksum.crc >> 8),
        "unpacker": struct.Struct("<" + "".join(codes)),
        "instance_field": None,
        "instance_offset": -1,
    }
    return type(f"MAVLink_{name.lower()}_message", (NewerMessage,), attributes)


NEWER: dict[int, type[NewerMessage]] = {
    number: _class_of(number, name, fields)
    for number, (name, fields) in _DEFINITIONS.items()
    if number not in mavlink.mavlink_map
}
"""The classes by message id."""


def message_number(name: str) -> int:
    """Return the id of a message, of the dialect or of those here, by its name, in small letters or capitals."""
    number: int | None = getattr(mavlink, f"MAVLINK_MSG_ID_{name.upper()}", None)
    return int(globals()[name.upper()]) if number is None else number
