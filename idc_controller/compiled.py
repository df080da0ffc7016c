"""Compile fixed-size numeric kernels with numba; the machine code is cached on disk beside the module."""

import hashlib
from collections.abc import Callable, Iterator
from functools import cache
from types import CodeType, ModuleType
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba.core.caching import IndexDataCacheFile

from idc_controller.kernel_loading import LeanFunctionCache

Function = TypeVar("Function", bound=Callable[..., Any])


def kernel(signature: str) -> Callable[[Function], Function]:
    """Compile a function for one signature, e.g. ``"float64(float64[:], float64[:, ::1])"``.

    One signature, given beforehand: nothing is ever compiled in flight, and arguments of another type raise TypeError.
    Arithmetic keeps its order (no fast math), and a division by zero gives inf or nan as in numpy. The function itself
    stays at hand as attribute ``py_func``. Modules of kernels are named ``*kernels.py``: installation compiles them all
    (``python -m vehicle_sim.app.compile_kernels``).
    """

    def compiled(function: Function) -> Function:
        dispatcher: Any = inlined(function)
        if dispatcher is not function:  # as it is with NUMBA_DISABLE_JIT
            dispatcher._cache = _KernelCache(function)
            dispatcher.compile(signature)
            dispatcher.disable_compile()
        return cast(Function, dispatcher)

    return compiled


def inlined(function: Function) -> Function:
    """Compile a small function as a part of the kernels that call it."""
    return cast(Function, numba.njit(error_model="numpy")(function))


class _KernelCache(LeanFunctionCache):
    """Numba's cache on disk, with files of their own for each state of all that a kernel's machine code follows from.

    Numba by itself looks at the kernel's own module alone, but kernels call functions and name constants of others.
    """

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]
        checksum = _checksum(function)
        name = f"{self._impl.filename_base}-{checksum[:16]}"
        self._cache_file = IndexDataCacheFile(self._cache_path, name, source_stamp=checksum)


@cache
def _checksum(function: Callable[..., Any]) -> str:
    """Return the SHA-256 of a function's code and of all that it names, down to the last called function."""
    bound = (function.__defaults__, *(cell.cell_contents for cell in function.__closure__ or ()))
    parts = (
        *_parts(function.__code__, function.__globals__),
        *_parts_of_value(bound, ()),
        *_parts(inlined.__code__, {}),  # numba's options
    )
    return hashlib.sha256("\n".join(parts).encode()).hexdigest()


def _parts(code: CodeType, variables: dict[str, Any]) -> Iterator[str]:
    yield code.co_code.hex()
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            yield from _parts(constant, variables)
        else:
            yield repr(constant)
    for name in code.co_names:
        yield name
        if name in variables:
            yield from _parts_of_value(variables[name], code.co_names)


def _parts_of_value(value: Any, names: tuple[str, ...]) -> Iterator[str]:
    """Yield what stands for a value of a variable; ``names``: the attributes that may be asked of it."""
    if hasattr(value, "py_func"):
        yield _checksum(value.py_func)
    elif isinstance(value, ModuleType | type):
        yield value.__name__
        for name in names:
            if name in vars(value):
                yield from _parts_of_value(vars(value)[name], names)
    elif isinstance(value, tuple):
        for element in value:
            yield from _parts_of_value(element, names)
    elif isinstance(value, np.ndarray):
        yield f"{value.dtype} {value.shape} {value.tobytes().hex()}"
    elif hasattr(value, "__name__"):  # a function that numba knows by itself
        yield f"{getattr(value, '__module__', '')}.{value.__name__}"
    else:
        yield repr(value)
