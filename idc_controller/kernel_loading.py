"""Machine code from numba's cache: loaded without what only the compilation of further kernels needs."""

from collections.abc import Sequence
from typing import Any

from llvmlite import binding
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import compile_result
from numba.core.environment import Environment, lookup_environment
from numba.core.runtime.nrt import rtsys


class _LoadedLibrary(JITCodeLibrary):
    """The machine code of a kernel. Its bitcode is parsed once a kernel is compiled that calls this one."""

    bitcode = b""

    def _get_module_for_linking(self) -> Any:
        if self._shared_module is None:
            self._shared_module = binding.parse_bitcode(self.bitcode)
        return self._shared_module

    def get_pointer_to_function(self, name: str) -> Any:
        return self._codegen._engine.get_function_address(name)


class _Constants:
    """The environment of an inner function as it is written to disk: numba's would import the function's module."""

    def __init__(self, environment: Any) -> None:
        self._environment = environment

    def __reduce__(self) -> tuple[Any, ...]:
        found = self._environment
        return _environment, (found.globals["__name__"], list(found.consts), found.env_name)


def _environment(module: str, constants: Sequence[Any], name: str) -> Any:
    """Return the environment ``name``; of the module's variables compiled code reads none."""
    found = lookup_environment(name)
    if found is None:
        found = Environment({"__name__": module})
        found.consts[:] = constants
        found.env_name = name
        Environment._memo[name] = found
    return found


class _LoadedKernel(CompileResultCacheImpl):
    """How a kernel is written to disk, and read back."""

    def reduce(self, compiled: Any) -> tuple[Any, ...]:
        """Return what numba writes, of the environments of inner functions those alone that the machine code reads."""
        *parts, environments = super().reduce(compiled)  # type: ignore[no-untyped-call]
        code = str(compiled.library._final_module)
        return *parts, tuple(_Constants(found) for found in environments if code.count(found.env_name) > 1)

    def rebuild(self, target_context: Any, payload: tuple[Any, ...]) -> Any:
        """Return what :class:`numba.core.compiler.CompileResult` has made for the disk as its like."""
        (name, _, codes), fndesc, environment, signature, objectmode, lifted, annotation, initialise, others = payload
        for function in initialise:
            function()
        new_library: Any = _LoadedLibrary
        library = new_library(target_context.codegen(), name)
        machine_code, library.bitcode = codes
        library.enable_object_caching()
        library._set_compiled_object(machine_code)
        library._finalize_final_module()
        entry_point = target_context.get_executable(library, fndesc, environment)
        for other in others:
            library.codegen.set_env(other.env_name, other)
        return compile_result(
            target_context=target_context, typing_context=target_context.typing_context, library=library,
            environment=environment, entry_point=entry_point, fndesc=fndesc, type_annotation=annotation,
            signature=signature, objectmode=objectmode, lifted=lifted, reload_init=initialise, referenced_envs=others,
        )  # fmt: skip


class LeanFunctionCache(FunctionCache):
    """Numba's cache on disk. A kernel that it has needs none of the registries by which numba compiles."""

    _impl_class = _LoadedKernel

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """Return the kernel on disk for a signature, None if there is none."""
        rtsys.initialize(target_context)
        cache: Any = super()
        return cache._load_overload(sig, target_context)
