"""Compile every kernel of the project into numba's cache: ``python -m vehicle_sim.app.compile_kernels``."""

import os
import sys
import traceback
from concurrent.futures import ProcessPoolExecutor
from importlib import import_module
from pathlib import Path

import gcs
import idc_controller
import idc_controller.compiled  # shared by the processes
import vehicle_sim
from gcs.drivers.forked_program import FORK


def compile_kernels() -> list[str]:
    """Import all modules of kernels, each in one of as many processes as there are cores; return their names.

    That compiles what the cache lacks. A module that calls kernels of another one compiles them itself where no other
    process has done so yet. Raises :class:`RuntimeError` with the traceback of every module that cannot be compiled.
    """
    found = _modules_of_kernels()
    with ProcessPoolExecutor(len(os.sched_getaffinity(0)), FORK) as processes:
        failures = [failure for failure in processes.map(_failure_to_import, found) if failure]
    if failures:
        raise RuntimeError("\n".join(failures))
    return found


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
