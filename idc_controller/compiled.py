"""Compile fixed-size numeric kernels with numba; the machine code is cached on disk beside the module."""

from collections.abc import Callable
from typing import Any, TypeVar, cast

import numba

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(signature: str) -> Callable[[Function], Function]:
    """Compile a function for one signature, e.g. ``"float64(float64[:], float64[:, ::1])"``.

    One signature, given beforehand: nothing is ever compiled in flight, and arguments of another type raise TypeError.
    Arithmetic keeps its order (no fast math), and a division by zero gives inf or nan as in numpy. The function itself
    stays at hand as attribute ``py_func``. Modules of kernels are named ``*kernels.py``: installation compiles them all
    (``python -m vehicle_sim.app.compile_kernels``).
    """
    return cast(Callable[[Function], Function], numba.njit(signature, cache=True, error_model="numpy"))


def inlined(function: Function) -> Function:
    """Compile a small function as a part of the kernels that call it."""
    return cast(Function, numba.njit(cache=True, error_model="numpy")(function))
