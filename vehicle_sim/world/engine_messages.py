"""Output of the physics engine, below Python's streams, kept out of the program's output; and its window."""

import contextlib
import ctypes
import ctypes.util
import os
import sys
from collections.abc import Iterator

from vehicle_sim.world.errors import SimulationError

_OUTPUT, _ERRORS = 1, 2


@contextlib.contextmanager
def messages_of_engine_aside() -> Iterator[None]:
    """Redirect standard output to standard error."""
    sys.stdout.flush()
    with _redirected(_OUTPUT, os.dup(_ERRORS)):
        yield


@contextlib.contextmanager
def greeting_of_engine_dropped() -> Iterator[None]:
    """Discard what the import of the engine prints to standard error: its build date."""
    with _redirected(_ERRORS, os.open(os.devnull, os.O_WRONLY)):
        yield


@contextlib.contextmanager
def _redirected(stream: int, target: int) -> Iterator[None]:
    """``stream`` writes to ``target`` (which is taken over) while the block runs."""
    try:
        kept = os.dup(stream)
    except OSError:  # it is closed: nothing gets out anyway
        os.close(target)
        yield
        return
    os.dup2(target, stream)
    os.close(target)
    try:
        yield
    finally:
        os.dup2(kept, stream)
        os.close(kept)


def check_display() -> None:
    """Raise :class:`SimulationError` where no window can be opened."""
    if not sys.platform.startswith("linux"):
        return
    name = os.environ.get("DISPLAY")
    if not name:
        raise SimulationError("--gui: there is no display (DISPLAY is not set)")
    try:
        x11 = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
    except OSError:
        raise SimulationError("--gui: there is no display (libX11 is not installed)") from None
    x11.XOpenDisplay.restype = ctypes.c_void_p
    x11.XOpenDisplay.argtypes = [ctypes.c_char_p]
    x11.XCloseDisplay.argtypes = [ctypes.c_void_p]
    display = x11.XOpenDisplay(None)
    if not display:
        raise SimulationError(f"--gui: there is no display (DISPLAY is {name!r}, and nobody answers)")
    x11.XCloseDisplay(display)
