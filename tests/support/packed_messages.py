"""Packed messages as message objects of pymavlink."""

from typing import Any

from gcs.mavlink.layout import Packed


def message_of(packed: Packed) -> Any:
    layout, payload = packed
    return layout.message(payload)
