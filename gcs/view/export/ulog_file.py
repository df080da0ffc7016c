"""The writer of ULog files, the logs of PX4 (docs.px4.io, "ULog File Format", version 1).

A file is a header, definitions (formats of the topics, information) and data: messages of a length, a kind and
contents, little-endian.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from idc_controller.arrays import Array

Topic = NDArray[np.void]
"""Rows of a topic; the first field is ``timestamp`` (us)."""

_MAGIC = b"ULog\x01\x12\x35\x01"
_TYPES = {"<u8": "uint64_t", "<u4": "uint32_t", "<f4": "float", "|b1": "bool", "|u1": "uint8_t"}
_TYPE_OF = {"f": "<f4", "b": "|b1", "u": "|u1"}
"""Types that :func:`topic` writes, by the kind of the values."""


class LoggedMessage(NamedTuple):
    """A text for people; ``severity`` as of syslog and MAV_SEVERITY."""

    time: float
    """s"""
    severity: int
    text: str


def topic(times: Array, **fields: ArrayLike) -> Topic:
    """Return the rows of a topic at ``times`` (n,) (s), in order of time.

    ``fields``: floats, booleans, or unsigned numbers of a byte, (n,), (n, k) for arrays, or one for all rows.
    """
    values = {name: np.asarray(value) for name, value in fields.items()}
    form = [(name, _TYPE_OF[value.dtype.kind], value.shape[1:]) for name, value in values.items()]
    rows = np.empty(len(times), [("timestamp", "<u8"), *form])
    rows["timestamp"] = np.rint(np.maximum(times, 0.0) * 1e6)
    for name, value in values.items():
        rows[name] = value
    return rows[np.argsort(rows["timestamp"], kind="stable")]


def ulog(
    topics: Mapping[str, Topic], information: Mapping[str, str] | None = None, messages: Sequence[LoggedMessage] = ()
) -> bytes:
    """Return a ULog file; topics without rows are left out.

    Args:
        topics: by name.
        information: texts by key.
        messages: logged ones.
    """
    topics = {name: rows for name, rows in topics.items() if len(rows)}
    timed = [(round(max(each.time, 0.0) * 1e6), _logged(each)) for each in messages]
    for number, rows in enumerate(topics.values()):
        timed += zip(rows["timestamp"].tolist(), _data(number, rows), strict=True)
    timed.sort(key=lambda each: each[0])
    start = timed[0][0] if timed else 0
    return b"".join(
        [
            _MAGIC + struct.pack("<Q", start),
            _message(b"B", bytes(40)),
            *[_message(b"F", _format(name, rows)) for name, rows in topics.items()],
            *[_message(b"I", _information(key, text)) for key, text in (information or {}).items()],
            *[
                _message(b"A", struct.pack("<BH", 0, number) + name.encode())
                for number, name in enumerate(topics)
            ],
            *[message for _, message in timed],
        ]
    )  # fmt: skip


def _message(kind: bytes, contents: bytes) -> bytes:
    return struct.pack("<Hc", len(contents), kind) + contents


def _format(name: str, rows: Topic) -> bytes:
    """Return the definition of a topic: its fields with their types, in the order of the bytes."""
    fields = []
    for field, (form, *_) in (rows.dtype.fields or {}).items():
        length = "".join(f"[{size}]" for size in form.shape)
        fields.append(f"{_TYPES[form.base.str]}{length} {field};")
    return f"{name}:{''.join(fields)}".encode()


def _information(key: str, text: str) -> bytes:
    contents = text.encode()
    typed = f"char[{len(contents)}] {key}".encode()
    return bytes([len(typed)]) + typed + contents


def _logged(message: LoggedMessage) -> bytes:
    level = str(min(max(message.severity, 0), 7)).encode()
    stamp = struct.pack("<Q", round(max(message.time, 0.0) * 1e6))
    return _message(b"L", level + stamp + message.text.encode())


def _data(number: int, rows: Topic) -> list[bytes]:
    """Return a message for each row of the topic of a number."""
    head = [("length", "<u2"), ("kind", "S1"), ("number", "<u2")]
    whole = np.empty(len(rows), [*head, ("row", rows.dtype)])
    whole["length"], whole["kind"], whole["number"], whole["row"] = rows.dtype.itemsize + 2, b"D", number, rows
    size, data = whole.dtype.itemsize, whole.tobytes()
    return [data[at : at + size] for at in range(0, len(data), size)]
