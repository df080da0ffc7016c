"""Set-points that a ground station has sent, as a table."""

from collections.abc import Sequence

import numpy as np
import pymavlink.dialects.v20.ardupilotmega as mavlink
from numpy.typing import NDArray

from gcs.mavlink.address import Address
from gcs.mavlink.frames import spans
from gcs.mavlink.layout import LAYOUTS

SETPOINT_COLUMNS = ("time_s", "vehicle", "qw", "qx", "qy", "qz", "thrust")
"""Time of sending, system id, attitude (body to world, w first), and thrust as a share of the largest one (0 to 1)."""
_LAYOUT = LAYOUTS[mavlink.MAVLINK_MSG_ID_SET_ATTITUDE_TARGET]
_ID = slice(7, 10)  # of the message, in a frame of MAVLink 2
_PAYLOAD, _CHECKSUM = 10, 2  # bytes before and behind the payload


class SentSetpoints:
    """Keeps the datagrams of a flight to the vehicles, and reads the set-points in them when they are asked for."""

    def __init__(self) -> None:
        self._sent: list[tuple[float, bytes]] = []

    def add(self, now: float, datagrams: Sequence[tuple[bytes, Address]]) -> None:
        """Keep what was sent at ``now`` (s); of copies of one datagram, the first."""
        last = b""
        for datagram, _ in datagrams:
            if datagram is not last:
                self._sent.append((now, datagram))
            last = datagram

    def table(self) -> NDArray[np.void]:
        """Return a row for each SET_ATTITUDE_TARGET (rows,), columns as :data:`SETPOINT_COLUMNS`."""
        rows = []
        for now, datagram in self._sent:
            for start, end in spans(datagram):
                if datagram[start:end][_ID] == _LAYOUT.wire_id:
                    fields = _LAYOUT.fields(datagram[start + _PAYLOAD : end - _CHECKSUM])
                    _, qw, qx, qy, qz, _, _, _, thrust, vehicle, *_ = fields
                    rows.append((now, vehicle, qw, qx, qy, qz, thrust))
        kinds = (float, int, *[float] * 5)
        return np.array(rows, dtype=[*zip(SETPOINT_COLUMNS, kinds, strict=True)])
