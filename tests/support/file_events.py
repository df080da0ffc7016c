"""Waiting for what other processes do: files that they make, and their end."""

import contextlib
import ctypes
import os
import select

from programs import PATIENCE

_IN_CREATE, _IN_MOVED_TO = 0x100, 0x80
_libc = ctypes.CDLL(None, use_errno=True)


def wait_for_file(folder, pattern):
    """Wait for a file of this pattern, in ``folder`` or in a folder of it (inotify)."""
    events = _libc.inotify_init()
    assert events >= 0, os.strerror(ctypes.get_errno())
    try:
        while True:
            # Before the look: what comes after it is an event.
            for watched in (folder, *(path for path in folder.iterdir() if path.is_dir())):
                _libc.inotify_add_watch(events, os.fsencode(watched), _IN_CREATE | _IN_MOVED_TO)
            if any(folder.glob(pattern)):
                return
            assert select.select([events], (), (), PATIENCE)[0], f"no {pattern} in {folder}"
            os.read(events, 65536)
    finally:
        os.close(events)


def wait_for_ends(processes):
    """Wait for the end of all processes that ``processes()`` lists (ids), until there are none."""
    while found := processes():
        for process in found:
            with contextlib.suppress(ProcessLookupError):
                end = os.pidfd_open(process)
                try:
                    assert select.select([end], (), (), PATIENCE)[0], f"process {process} has not ended"
                finally:
                    os.close(end)
