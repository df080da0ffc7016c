"""Imports of what a flight needs: without collections of garbage, and with its kernels compiled beforehand."""

import gc
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from idc_controller import uncompiled

_COMPILER = "vehicle_sim.app.compile_kernels"
_INTERRUPTED = 130


@contextmanager
def importing() -> Iterator[None]:
    """Collect no garbage within; if modules came, later collections pass over what is there, the last one, too.

    The imports of a flight make 200,000 objects that stay, which every collection would look through. If kernels lack
    machine code, all are compiled at once, by all cores, with a line of progress: the first time that takes minutes.
    """
    collects, before = gc.isenabled(), len(sys.modules)
    gc.disable()
    uncompiled.compile_all = _compile_all
    try:
        yield
    finally:
        if len(sys.modules) > before:  # else it would keep the garbage of flights before
            gc.freeze()
        if collects:
            gc.enable()


def _compile_all() -> None:
    import signal
    import subprocess

    command = [sys.executable, "-m", _COMPILER]
    with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL) as compiler:
        try:
            interrupted = compiler.wait() == _INTERRUPTED
        except KeyboardInterrupt:
            compiler.send_signal(signal.SIGINT)
            raise
    if interrupted:
        raise KeyboardInterrupt
