"""The telemetry of a run by system and kind of message, as arrays."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
from numpy.typing import NDArray

from gcs.mavlink.layout import LAYOUTS
from gcs.view.export.systems import is_of_team
from gcs.view.export.tlog_records import records
from idc_controller.arrays import Array


class Messages(NamedTuple):
    """Messages of one kind, in the order in which they were recorded."""

    time: Array
    """Of the vehicle's clock (s): the message's own, or the last one that the vehicle had stamped a message with."""
    fields: NDArray[np.void]


FROM_VEHICLE = (
    mavlink.MAVLINK_MSG_ID_HEARTBEAT, mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED,
    mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, mavlink.MAVLINK_MSG_ID_ATTITUDE_TARGET,
    mavlink.MAVLINK_MSG_ID_EXTENDED_SYS_STATE, mavlink.MAVLINK_MSG_ID_BATTERY_STATUS, mavlink.MAVLINK_MSG_ID_STATUSTEXT,
)  # fmt: skip
"""Messages of a vehicle that are read."""
TO_VEHICLE = (mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET,)
"""Messages to a vehicle that are read."""
STAMPED = (
    mavlink.MAVLINK_MSG_ID_LOCAL_POSITION_NED, mavlink.MAVLINK_MSG_ID_ATTITUDE_QUATERNION, *TO_VEHICLE
)  # fmt: skip
"""Messages that bear the time of the vehicle's clock; ATTITUDE_TARGET bears that of the set-point in force."""


class Telemetry:
    """What was recorded of each system, by its id."""

    def __init__(self, messages: Mapping[tuple[int, int], Messages]) -> None:
        """``messages`` by system and message id."""
        self._messages = messages

    @property
    def systems(self) -> tuple[int, ...]:
        """Systems of which there is something."""
        return tuple(sorted({system for system, number in self._messages if number not in TO_VEHICLE}))

    def of(self, system: int, message_id: int) -> Messages:
        """Return the messages of one kind of a system, or to it (:data:`TO_VEHICLE`); none where none was recorded."""
        found = self._messages.get((system, message_id))
        return found or Messages(np.empty(0), np.empty(0, LAYOUTS[message_id].dtype))


def read_telemetry(run_dir: Path) -> Telemetry:
    """Read the telemetry log of a run. Raises :class:`gcs.errors.UnusableInput`, see :func:`records`."""
    payloads: dict[tuple[int, int], list[bytes]] = defaultdict(list)
    times: dict[tuple[int, int], list[float]] = defaultdict(list)
    clocks: dict[int, float] = defaultdict(float)
    for record in records(run_dir):
        layout = record.layout
        if layout is None or layout.message_id not in (*FROM_VEHICLE, *TO_VEHICLE):
            continue
        received = layout.message_id in TO_VEHICLE
        system = record.target if received else record.sender
        if not is_of_team(system):
            continue
        size = layout.dtype.itemsize
        payload = record.payload.ljust(size, b"\0")[:size]  # trailing zeros are not sent, later versions are longer
        time = clocks[system]
        if layout.message_id in STAMPED:
            time = float(np.frombuffer(payload, layout.dtype)["time_boot_ms"][0]) * 1e-3
            if not received:
                clocks[system] = time
        payloads[system, layout.message_id].append(payload)
        times[system, layout.message_id].append(time)
    return Telemetry(
        {
            (system, number): Messages(
                np.array(times[system, number]), np.frombuffer(b"".join(found), LAYOUTS[number].dtype)
            )
            for (system, number), found in payloads.items()
        }
    )
