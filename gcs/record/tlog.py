"""``telemetry.tlog``: every MAVLink frame of a flight, both ways, in the form that ground stations share.

A record is a time stamp (microseconds since 1970, 8 bytes, big-endian) and one raw MAVLink frame. Tools that
log several links keep the link's number in the two lowest bits of the time stamp; they are 0 here.
"""

from itertools import accumulate
from pathlib import Path

import numpy as np

from gcs.mavlink.frame_kernels import stamped_frames
from gcs.record.append_file import AppendOnlyFile
from gcs.record.incomplete import IncompleteRecords


class TelemetryLog(AppendOnlyFile):
    """Writes a tlog; ``start_epoch`` is the wall-clock time (s since 1970, UTC) of flight time 0.

    The frames of one exchange go to the operating system together: with :meth:`flush`, or when the file is closed.
    """

    def __init__(self, path: Path | str, start_epoch: float, incomplete: IncompleteRecords | None = None) -> None:
        super().__init__(path, incomplete)
        self._start_us = round(start_epoch * 1e6)
        self._stamps: list[int] = []
        self._datagrams: list[bytes] = []

    def write(self, now: float, *datagrams: bytes) -> None:
        """Record datagrams that were sent or received at flight time ``now`` (s): one record a frame.

        Bytes that belong to no frame, as a damaged datagram may hold, are left out.
        """
        self._stamps += [(self._start_us + round(now * 1e6)) & ~0x3] * len(datagrams)
        self._datagrams += datagrams

    def flush(self) -> None:
        """Append the frames that were recorded since the last call."""
        if not self._datagrams:
            return
        data = np.frombuffer(bytearray().join(self._datagrams), np.uint8)
        ends, stamps = np.array([*accumulate(map(len, self._datagrams))]), np.array(self._stamps)
        self._stamps.clear()
        self._datagrams.clear()
        if records := stamped_frames(data, ends, stamps).tobytes():
            self.append(records)

    def close(self) -> None:
        """Append what waits, and close the file; harmless when it is closed already."""
        self.flush()
        super().close()
