"""The records of a telemetry log: time stamps and MAVLink frames."""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from gcs.errors import UnusableInput
from gcs.mavlink.frame_kernels import STAMP_BYTES
from gcs.mavlink.frames import V1, V2, end_of_frame
from gcs.mavlink.layout import LAYOUTS, Layout

TELEMETRY = "telemetry.tlog"
_HEADER = {True: 6, False: 10}
"""Bytes of a frame before its payload, by whether it is of MAVLink 1."""


class Record(NamedTuple):
    """A frame as it stands in the log; ``layout`` is None for a kind of message that the dialect does not have."""

    record: bytes
    """Time stamp and frame."""
    sender: int
    """System id of who sent it."""
    layout: Layout | None
    payload: bytes

    @property
    def target(self) -> int:
        """System id of whom the message is for; 0: it names none."""
        if self.layout is None or not self.layout.target_offsets:
            return 0
        offset = self.layout.target_offsets[0]
        return self.payload[offset] if offset < len(self.payload) else 0  # trailing zeros are not sent


def records(run_dir: Path) -> Iterator[Record]:
    """Yield the records of the telemetry log of a run; a last one that is cut off, as by SIGKILL, is left out.

    Raises :class:`UnusableInput` where there is none, and where it is no telemetry log.
    """
    path = run_dir / TELEMETRY
    try:
        log = path.read_bytes()
    except FileNotFoundError:
        raise UnusableInput(f"{path}: is missing: there is no telemetry to export") from None
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
    at = 0
    while at + STAMP_BYTES < len(log):
        start = at + STAMP_BYTES
        end = end_of_frame(log, start, len(log))
        if not end:
            if log[start] in (V1, V2):  # its end is missing
                return
            raise UnusableInput(f"{path}, byte {start}: no MAVLink frame begins here")
        yield _record(log[at:end])
        at = end


def _record(record: bytes) -> Record:
    frame = record[STAMP_BYTES:]
    of_first_version = frame[0] == V1
    payload = frame[_HEADER[of_first_version] :][: frame[1]]
    system = frame[3] if of_first_version else frame[5]
    number = frame[5] if of_first_version else int.from_bytes(frame[7:10], "little")
    return Record(record, system, LAYOUTS.get(number), payload)
