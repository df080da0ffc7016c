"""Loss, latency and rate of the messages of each system, second by second, from ``telemetry.tlog``."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from gcs.errors import UnusableInput
from idc_controller.arrays import Array

_HEADER, _MAGIC = 8, 0xFD
"""Bytes of a time stamp, and the first of a frame of MAVLink 2."""
_TIMED = {30, 31, 32, 33}
"""Messages of the streams that begin with ``time_boot_ms``: ATTITUDE, ATTITUDE_QUATERNION, positions."""
_GROUND = 200
"""System ids from here on are ground stations."""


def link_figures(path: Path) -> tuple[Array, list[str], Mapping[str, Array]]:
    """Return the middles of seconds (K,) (s), names of the systems (L), and figures (K, L) by name.

    ``loss``: share of messages that are missing from the sequence (%). ``latency``: mean by which stamps of streams
    arrive later than the fastest of the flight did (ms). ``rate``: messages received (1/s). NaN where nothing came in.
    Times are those of the tables: the clock of vehicle 1, by its fastest message. K is 0 where the file is absent
    or has no frame. Raises :class:`UnusableInput` for a file that cannot be read.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return np.empty(0), [], {}
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be read: {error.strerror}") from None
    stamps, systems, missing, ages = _frames(data)
    if not len(stamps):
        return np.empty(0), [], {}
    found = np.unique(systems[systems < _GROUND])
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
    names = [f"vehicle {system}" if system < 100 else "payload" for system in found.tolist()]
    # The last second is not a whole one.
    return np.arange(begin + 0.5, begin + size - 1.0), names, {name: values[:-1] for name, values in figures.items()}


def _frames(data: bytes) -> tuple[Array, Array, Array, Array]:
    """Return of each frame its stamp (us), system, messages missing before it, and age (ms; NaN: it has no time)."""
    stamps, systems, missing, ages = [], [], [], []
    last: dict[int, int] = {}
    at, end = 0, len(data) - _HEADER - 12
    while at <= end:
        head = at + _HEADER
        if data[head] != _MAGIC:  # of another version, or damaged: from the next byte on
            at += 1
            continue
        length = data[head + 1]
        sequence, system = data[head + 4], data[head + 5]
        source = system << 8 | data[head + 6]
        stamp = int.from_bytes(data[at:head], "big")
        gap = (sequence - last.get(source, sequence - 1) - 1) % 256
        age = np.nan
        if data[head + 7] in _TIMED and not data[head + 8] and not data[head + 9] and length >= 4:
            age = stamp / 1e3 - int.from_bytes(data[head + 10 : head + 14], "little")
        stamps.append(stamp)
        systems.append(system)
        missing.append(gap if gap < 128 else 0)  # what comes behind a later one was overtaken
        ages.append(age)
        if gap < 128:
            last[source] = sequence
        at = head + length + (25 if data[head + 2] & 1 else 12)
    return np.array(stamps, dtype=float), np.array(systems), np.array(missing, dtype=float), np.array(ages)
