"""Check of the display: the physics engine ends the process when it cannot open its window."""

import ctypes
import ctypes.util
import os
import sys

from vehicle_sim.world.errors import SimulationError


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
