"""Compile every kernel of the project into numba's cache: ``python -m vehicle_sim.app.compile_kernels``."""

import fcntl
import multiprocessing
import os
import signal
import sys
import traceback
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor, as_completed
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from pathlib import Path

from numba.misc.appdirs import AppDirs
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

import gcs
import idc_controller
import idc_controller.compiled  # shared by the processes
import vehicle_sim
from gcs.drivers.forked_program import FORK

_LOCK = Path(AppDirs("cooplift", appauthor=False).user_cache_dir) / "compiling"
_TITLE = "compiling numeric kernels that are not on disk yet (all of them: minutes)"
_INTERRUPTED = 130


def compile_kernels() -> list[str]:
    """Import all modules of kernels, each in one of as many processes as there are cores; return their names.

    That compiles what the cache lacks. A module that calls kernels of another one compiles them itself where no other
    process has done so yet. One process at a time does so; others wait, and find all of it. Shows the progress on
    standard error. Raises :class:`RuntimeError` with the traceback of every module that cannot be compiled.
    """
    found = _modules_of_kernels()
    columns = (TextColumn(_TITLE), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    console = Console(stderr=True, highlight=False)
    if not console.is_terminal:
        console.print(_TITLE)
    bar = Progress(*columns, console=console, transient=True, disable=not console.is_terminal)
    cores = len(os.sched_getaffinity(0))
    with _one_at_a_time(), ProcessPoolExecutor(cores, FORK, _leave_signals_to_parent) as processes:
        modules = [processes.submit(_failure_to_import, module) for module in found]
        try:
            with bar:  # a thread, after the forks
                for _ in bar.track(as_completed(modules), len(modules)):
                    pass
        except KeyboardInterrupt:
            for process in multiprocessing.active_children():
                process.terminate()
            raise
    if failures := [module.result() for module in modules if module.result()]:
        raise RuntimeError("\n".join(failures))
    return found


@contextmanager
def _one_at_a_time() -> Iterator[None]:
    """Hold the user's lock, where that can be written."""
    with ExitStack() as held:
        with suppress(OSError):
            _LOCK.parent.mkdir(parents=True, exist_ok=True)
            fcntl.flock(held.enter_context(_LOCK.open("w")), fcntl.LOCK_EX)
        yield


def _leave_signals_to_parent() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _modules_of_kernels() -> list[str]:
    """Return the names of all modules of kernels, the largest first: they take longest."""
    paths: dict[str, Path] = {}
    for package in (idc_controller, gcs, vehicle_sim):
        root = Path(package.__path__[0])
        for path in root.rglob("*kernels.py"):
            if path != Path(__file__):
                paths[".".join((package.__name__, *path.relative_to(root).with_suffix("").parts))] = path
    return sorted(paths, key=lambda name: (-paths[name].stat().st_size, name))


def _failure_to_import(module: str) -> str:
    try:
        import_module(module)
    except Exception:
        return f"{module} cannot be compiled:\n{traceback.format_exc()}"
    return ""


if __name__ == "__main__":
    try:
        compile_kernels()
    except RuntimeError as error:
        sys.exit(str(error))
    except KeyboardInterrupt:
        sys.exit(_INTERRUPTED)
