"""Compile numeric kernels with numba; the machine code is kept on disk for all checkouts."""

import hashlib
from collections.abc import Callable, Iterator
from contextlib import suppress
from functools import cache
from types import CodeType, ModuleType
from typing import Any, TypeVar, cast, get_args, get_origin, get_type_hints

import numba
import numpy as np
from numba.core import config as numba_config
from numba.core import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.misc.appdirs import AppDirs
from numba.np.numpy_support import from_dtype

from idc_controller import uncompiled

Function = TypeVar("Function", bound=Callable[..., Any])
_CONFIG: Any = numba_config

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "no_cfunc_wrapper": True}
_NUMBERS = {float: types.float64, int: types.int64, bool: types.boolean, type(None): types.none}


def kernel(function: Function) -> Function:
    """Compile a function for the types that its annotations name: numbers, contiguous arrays, and tuples of these.

    One signature, given beforehand: nothing is ever compiled in flight, and arguments of another type raise TypeError.
    Arithmetic keeps its order (no fast math), and a division by zero gives inf or nan as in numpy. The function itself
    stays at hand as attribute ``py_func``. Modules of kernels are named ``*kernels.py``: installation compiles them all
    (``python -m vehicle_sim.app.compile_kernels``).

    An array is written into a part of another one by a loop: for an assignment numba compiles a formatted error
    message, which takes seconds.
    """
    dispatcher: Any = numba.njit(**_OPTIONS)(function)
    if dispatcher is not function:  # as it is with NUMBA_DISABLE_JIT
        cache: Any = _KernelCache
        dispatcher._cache = cache(function)
        *arguments, result = map(_type_of, get_type_hints(function, include_extras=True).values())
        dispatcher.compile(result(*arguments))
        dispatcher.disable_compile()
    return cast(Function, dispatcher)


def _type_of(hint: Any) -> Any:
    """Return numba's type for an annotation of a kernel; the arrays are those of :mod:`idc_controller.arrays`."""
    if hint in _NUMBERS:
        return _NUMBERS[hint]
    if hasattr(hint, "_fields"):
        return types.NamedTuple([_type_of(of) for of in get_type_hints(hint, include_extras=True).values()], hint)
    if get_origin(hint) is tuple:
        return types.Tuple([_type_of(of) for of in get_args(hint)])
    array, layout = get_args(hint)
    (dtype,) = get_args(get_args(array)[1])
    return types.Array(from_dtype(np.dtype(dtype)), layout.axes, "C", readonly=layout.is_read_only)


def inlined(function: Function) -> Function:
    """Compile a small function as a part of the kernels that call it."""
    return cast(Function, numba.njit(**_OPTIONS)(function))


class _ByContent(_CacheLocator):
    """Where numba keeps a kernel: by a checksum of all that its machine code follows from, so for any checkout.

    Numba's own locators look at the path and the text of the kernel's module alone, but kernels call functions and name
    constants of others.
    """

    def __init__(self, function: Callable[..., Any], folder: str) -> None:
        self._folder, self._checksum = folder, _checksum(function)

    def get_cache_path(self) -> str:
        """Return the folder."""
        return self._folder

    def get_source_stamp(self) -> str:
        """Return what the kernel has to have been compiled from."""
        return self._checksum

    def get_disambiguator(self) -> str:
        """Return what distinguishes files of one name."""
        return self._checksum[:16]

    @classmethod
    def from_function(cls, function: Callable[..., Any], path: str) -> Any:
        """Return that of the first folder that can be written: ``NUMBA_CACHE_DIR``, the user's, beside the module."""
        beside = f"{path.rpartition('/')[0]}/__pycache__"
        for folder in filter(None, (_CONFIG.CACHE_DIR, AppDirs("cooplift", False).user_cache_dir, beside)):
            locator: Any = cls(function, folder)
            with suppress(OSError):
                locator.ensure_cache_path()
                return locator
        return None


class _KernelFiles(CompileResultCacheImpl):
    _locator_classes = [_ByContent]  # noqa: RUF012


class _KernelCache(FunctionCache):
    _impl_class = _KernelFiles

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the kernel on disk for a signature, None if there is none."""
        load: Callable[..., Any] = super().load_overload
        found = load(sig, target_context)
        if found is None and uncompiled.compile_all is not None:
            compile_all, uncompiled.compile_all = uncompiled.compile_all, None
            compile_all()
            found = load(sig, target_context)
        return found


@cache
def _checksum(function: Callable[..., Any]) -> str:
    """Return the SHA-256 of a function's code and of all that it names, down to the last called function."""
    bound = (function.__defaults__, *(cell.cell_contents for cell in function.__closure__ or ()))
    parts = (
        *_parts(function.__code__, function.__globals__),
        *_parts_of_value(bound, ()),
        repr(_OPTIONS),
        numba.__version__,
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
