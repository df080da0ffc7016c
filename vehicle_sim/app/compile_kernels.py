"""Compile every kernel of the project into numba's cache: ``python -m vehicle_sim.app.compile_kernels``."""

import pkgutil
from importlib import import_module

import gcs
import idc_controller
import vehicle_sim


def compile_kernels() -> list[str]:
    """Import all modules of kernels, which compiles what the cache lacks; return their names."""
    found = [
        module.name
        for package in (idc_controller, gcs, vehicle_sim)
        for module in pkgutil.walk_packages(package.__path__, package.__name__ + ".")
        if module.name.endswith("kernels") and module.name != __name__
    ]
    for name in found:
        import_module(name)
    return found


if __name__ == "__main__":
    compile_kernels()
