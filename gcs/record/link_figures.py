"""Loss, latency and rate of the messages of each system, second by second, from ``telemetry.tlog``."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from gcs.errors import UnusableInput
from gcs.mavlink.frame_kernels import STAMP_BYTES, frames_in_log
from gcs.mavlink.frames import HEADER, V2
from gcs.mavlink.link_statistics import NUMBERS
from gcs.mavlink.px4 import GROUND_SYSTEM, PAYLOAD_UNIT_SYSTEM
from idc_controller.arrays import Array, Cells, Indices

_TIMED = (30, 31, 32, 33)
"""Messages of the streams that begin with ``time_boot_ms``: ATTITUDE, ATTITUDE_QUATERNION, positions."""


def link_figures(path: Path) -> tuple[Array, list[str], Mapping[str, Array]]:
    """Return the middles of seconds (K,) (s), names of the systems (L), and figures (K, L) by name.

    ``loss``: share of messages that are missing from the sequence (%). ``latency``: mean by which stamps of streams
    arrive later than the fastest of the flight did (ms). ``rate``: messages received (1/s). NaN where nothing came in.
    Times are those of the tables: the clock of vehicle 1, by its fastest message. K is 0 where the file is absent
    or has no frame. Raises :class:`UnusableInput` for a file that cannot be read.
    """
    try:
        data = np.fromfile(path, np.uint8)
    except FileNotFoundError:
        return np.empty(0), [], {}
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
    stamps, systems, missing, ages = _frames(data)
    if not len(stamps):
        return np.empty(0), [], {}
    found = np.unique(systems[systems != GROUND_SYSTEM])
    first = ages[(systems == found[0]) & np.isfinite(ages)] if len(found) else np.empty(0)
    time = stamps / 1e3 - (first.min() if len(first) else stamps[0] / 1e3)
    begin = float(np.floor(time.min() / 1e3))
    second = (time / 1e3 - begin).astype(int)
    size = int(second.max()) + 1
    figures = {name: np.full((size, len(found)), np.nan) for name in ("loss", "latency", "rate")}
    for column, system in enumerate(found.tolist()):
        own = systems == system
        count = np.bincount(second[own], minlength=size).astype(float)
        lost = np.bincount(second[own], weights=missing[own], minlength=size)
        timed = own & np.isfinite(ages)
        arrived = np.bincount(second[timed], minlength=size)
        figures["rate"][:, column] = count
        with np.errstate(invalid="ignore"):
            figures["loss"][:, column] = 100.0 * lost / (lost + count)
            if timed.any():
                age = np.bincount(second[timed], weights=ages[timed] - ages[timed].min(), minlength=size)
                figures["latency"][:, column] = age / arrived
    names = ["payload" if system == PAYLOAD_UNIT_SYSTEM else f"vehicle {system}" for system in found.tolist()]
    # The last second is not a whole one.
    return np.arange(begin + 0.5, begin + size - 1.0), names, {name: values[:-1] for name, values in figures.items()}


def _frames(data: Cells) -> tuple[Array, Indices, Array, Array]:
    """Return of each frame its stamp (us), system, messages missing before it, and age (ms; NaN: it has no time)."""
    begins = frames_in_log(data)
    begins = begins[data[begins] == V2]
    stamps = _number(data, begins - STAMP_BYTES, STAMP_BYTES)
    sequences, systems, components = (data[begins + at].astype(np.int64) for at in (4, 5, 6))
    missing = np.zeros(len(begins))
    last: dict[int, int] = {}
    for k, (source, sequence) in enumerate(zip((systems << 8 | components).tolist(), sequences.tolist(), strict=True)):
        gap = (sequence - last.get(source, sequence - 1) - 1) % NUMBERS
        if gap < NUMBERS // 2:  # what comes behind a later one was overtaken
            missing[k], last[source] = gap, sequence
    timed = np.isin(_number(data, begins + 7, -3), _TIMED) & (data[begins + 1] >= 4)
    ages = np.full(len(begins), np.nan)
    ages[timed] = stamps[timed] / 1e3 - _number(data, begins[timed] + HEADER, -4)
    return stamps.astype(float), systems, missing, ages


def _number(data: Cells, at: Indices, size: int) -> Indices:
    """Return the numbers (n,) of ``size`` bytes, big-endian, that begin ``at`` (n,); negative: little-endian."""
    shifts = 8 * np.arange(abs(size))
    read = data[at[:, None] + np.arange(abs(size))].astype(np.int64)
    return np.asarray((read << (shifts[::-1] if size > 0 else shifts)).sum(axis=1))
