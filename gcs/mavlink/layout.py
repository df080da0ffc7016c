"""How messages lie on the wire: one precompiled ``struct`` a kind, made from pymavlink's definition of it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from enum import Enum
from functools import cached_property
from itertools import accumulate
from operator import attrgetter, itemgetter
from struct import calcsize
from typing import Any, NamedTuple, TypeAlias

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
from numpy.typing import NDArray

from gcs.mavlink.newer_messages import NEWER

Message = mavlink.MAVLink_message


Packed: TypeAlias = "tuple[Layout, bytes]"
"""A message without its header, its layout and its payload: the same for all who get it."""


class PackedRun(NamedTuple):
    """Messages of one kind and time stamp, as an array of :attr:`Layout.dtype`, the last byte of each not zero."""

    layout: Layout
    values: NDArray[np.void]


class Sample(Enum):
    """What a message holds of the moment that its stamp names, by message id."""

    ATTITUDE = mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION
    POSITION = mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED
    SETPOINT = mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET
    """The set-point that a vehicle flies."""
    RETURNS = mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE_3D
    """A return of a scan, or a run of them."""
    SCAN_END = mavlink.MAVLINK_MSG_ID_OBSTACLE_DISTANCE
    """The end of a scan, behind its returns."""


_SAMPLES = {sample.value: sample for sample in Sample}


class Layout:
    """The kind of message ``kind``, and its conversion to and from the payload of a frame.

    Payloads are those of MAVLink 2, without trailing zeros. What is read may be shorter (zeros are missing), or longer
    (a later version of the message has further fields).
    """

    def __init__(self, kind: type[Message]) -> None:
        self.kind = kind
        self.message_id: int = kind.id
        self.sample = _SAMPLES.get(kind.id)
        """The kind of sample in such a message; None: it is no sample."""
        self.wire_id: bytes = kind.id.to_bytes(3, "little")
        """The message id as it is sent."""
        self.crc_extra = bytes([kind.crc_extra])
        """The last byte that a frame's checksum covers, which is not sent."""
        self._pack, self._unpack, self._size = kind.unpacker.pack, kind.unpacker.unpack_from, kind.unpacker.size
        names, lengths = list(kind.ordered_fieldnames), list(kind.array_lengths)
        codes = kind.native_format.decode().lstrip("<")
        texts = [i for i, code in enumerate(codes) if code == "c"]
        self._has_text = bool(texts)
        for i in texts:  # pymavlink keeps a text as it is on the wire beside the text that people read
            names[i], lengths[i] = f"_{names[i]}_raw", 0
        self.stamp_bytes = 8 if names[0] == "time_usec" else 4
        """Length of a stamp in front: 8 of microseconds, 4 of milliseconds."""
        self._values = _tuple_of(attrgetter, names)
        self._lengths = lengths if any(lengths) else None
        """Lengths of the fields in the order of the wire, 0: no array; None: there is no array."""
        firsts = accumulate((length or 1 for length in lengths), initial=0)
        places = [slice(i, i + length) if length else i for i, length in zip(firsts, lengths, strict=False)]
        self._order = _tuple_of(itemgetter, [places[i] for i in kind.orders])
        sizes = [calcsize(f"<{code}") * (length or 1) for code, length in zip(codes, kind.array_lengths, strict=True)]
        starts = dict(zip(kind.ordered_fieldnames, accumulate(sizes, initial=0), strict=False))
        self.target_offsets = [starts[name] for name in ("target_system", "target_component") if name in starts]
        """Where the payload holds the system and the component that a message is for, as far as it names them."""

    @cached_property
    def dtype(self) -> np.dtype[np.void]:
        """The fields in the order of the wire, for arrays of messages."""
        kind = self.kind
        codes = kind.native_format.decode().lstrip("<")
        return np.dtype(
            [
                (name, "S1" if code == "c" else f"<{code}", (length,) if length else ())
                for name, code, length in zip(kind.ordered_fieldnames, codes, kind.array_lengths, strict=True)
            ]
        )

    def pack(self, *values: float | bytes) -> Packed:
        """Return a message of these fields, in the order of the wire, arrays number by number.

        Raises ``struct.error`` or ``OverflowError`` when a field does not fit its type.
        """
        payload = self._pack(*values)
        return self, payload.rstrip(b"\0") or payload[:1]  # trailing zeros are not sent, but at least one byte is

    def pack_message(self, message: Message) -> Packed:
        """Return a message of this kind, packed. Raises as :meth:`pack`."""
        values: Iterable[Any] = self._values(message)
        if self._lengths is not None:
            flat: list[Any] = []
            for value, length in zip(values, self._lengths, strict=True):
                if length:
                    flat += value[:length]
                else:
                    flat.append(value)
            values = flat
        return self.pack(*values)

    def fields(self, payload: bytes) -> tuple[Any, ...]:
        """Return the fields in a payload, in the order of the wire, arrays number by number."""
        fields: tuple[Any, ...] = self._unpack(payload.ljust(self._size, b"\0"))
        return fields

    def message(self, payload: bytes) -> Message:
        """Return the message in a payload."""
        fields = self._order(self.fields(payload))
        if self._has_text:
            fields = tuple([field.rstrip(b"\0") if isinstance(field, bytes) else field for field in fields])
        return self.kind(*fields)


def packed(*messages: Message) -> tuple[Packed, ...]:
    """Return messages of ArduPilot's dialect, packed. Raises as :meth:`Layout.pack`."""
    # By the class: some messages have a field ``id``.
    return tuple([LAYOUTS[type(message).id].pack_message(message) for message in messages])


def _tuple_of(getter: Callable[..., Callable[[Any], Any]], keys: Sequence[Any]) -> Callable[[Any], tuple[Any, ...]]:
    """Return a function that gets ``keys`` of its argument, always as a tuple."""
    get = getter(*keys)
    return get if len(keys) > 1 else lambda source: (get(source),)


LAYOUTS: dict[int, Layout] = {number: Layout(kind) for number, kind in (mavlink.mavlink_map | NEWER).items()}
"""Layouts of ArduPilot's dialect, which holds the common one, and of newer common messages, by message id."""
