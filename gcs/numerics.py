"""Numeric libraries that choose their code by processor: one choice for all, so that a flight gives the same bytes.

The choice is that of x86-64 processors with AVX2 and FMA (x86-64-v3), the C library's among them:

=========  =============================  ===================================================================
library    choice                         where it is made
=========  =============================  ===================================================================
OpenBLAS   kernels "Haswell", one thread  :func:`choose_kernels`: of numpy and of scipy, as they are loaded
numpy      loops up to AVX2               :func:`choose_kernels`, as it is loaded
proxsuite  the build for AVX2             ``idc_controller/qp/__init__.py``
numba      any                            makes no difference (``tests/project/test_numerics.py``)
=========  =============================  ===================================================================

Imports nothing that loads one of them.
"""

from __future__ import annotations

import os
import platform
import sys
from collections.abc import Mapping, MutableMapping
from functools import cache
from pathlib import Path
from typing import Any

UNPINNED = "COOPLIFT_KERNELS"
"""Environment variable: ``unpinned`` leaves the choice to the libraries, and to the variables that they read."""
_THREADS = dict.fromkeys(("OPENBLAS_NUM_THREADS", "OMP_NUM_THREADS", "MKL_NUM_THREADS"), "1")
_NUMPY_LOOPS = {"X86_V3", "AVX2", "FMA3", "F16C", "AVX"}
"""Names of numpy 2.4, and those before."""
_KERNELS = {"OPENBLAS_CORETYPE": "Haswell", "NPY_ENABLE_CPU_FEATURES": " ".join(sorted(_NUMPY_LOOPS))}
_BLAS, _BLAS_OF = "openblas Haswell", "BLAS of "
_NUMPY_DISABLE = "NPY_DISABLE_CPU_FEATURES"
"""Excludes ``NPY_ENABLE_CPU_FEATURES``: numpy refuses both."""
_NEEDED = {"avx2", "fma"}
_NOT_PINNED = "results can differ in the last digits from those of other processors"


def choose_kernels(environment: MutableMapping[str, str] = os.environ) -> None:
    """Set the variables that the libraries read when they are loaded; call it before numpy is imported.

    A processor without AVX2 and FMA keeps the libraries' own choice: code that it lacks would end the program.
    """
    environment.update(_THREADS)
    if not _is_unpinned(environment) and processor_features() >= _NEEDED:
        environment.pop(_NUMPY_DISABLE, None)
        environment.update(_KERNELS)


def _is_unpinned(environment: Mapping[str, str]) -> bool:
    return environment.get(UNPINNED) == "unpinned"


@cache
def processor_features() -> frozenset[str]:
    """Return the instruction sets of this processor, by Linux's names; empty where the system does not list them."""
    return frozenset(_cpuinfo().get("flags", "").split())


@cache
def _cpuinfo() -> Mapping[str, str]:
    """Return what Linux says of the first processor."""
    try:
        text = Path("/proc/cpuinfo").read_text(encoding="utf-8", errors="replace")
    except OSError:
        return {}
    pairs = (line.partition(":") for line in text.partition("\n\n")[0].splitlines())
    return {name.strip(): value.strip() for name, _, value in pairs}


def numerics() -> dict[str, str]:
    """Return processor and code in use, for the manifest; of libraries, those that are loaded."""
    from threadpoolctl import threadpool_info

    found = {"processor": _cpuinfo().get("model name") or platform.processor() or platform.machine()}
    for library in threadpool_info():
        if library["user_api"] == "blas":
            owner = Path(library["filepath"]).parent.name.partition(".")[0]  # numpy.libs, scipy.libs
            found[f"{_BLAS_OF}{owner}"] = f"{library['internal_api']} {library.get('architecture', '')}".strip()
    if "numpy" in sys.modules:
        config: Any = sys.modules["numpy"].show_config("dicts")
        found["numpy"] = " ".join(config["SIMD Extensions"].get("found", ()))
    if "proxsuite" in sys.modules:
        found["proxsuite"] = sys.modules["proxsuite"].proxqp.__name__.split(".")[1]
    return found


def differences() -> str:
    """Return in what the code in use is not the one choice, as one sentence for the user; empty if it is."""
    found = numerics()
    if not processor_features() >= _NEEDED:
        return f"this processor ({found['processor']}) lacks AVX2 and FMA: {_NOT_PINNED}"
    others = [name for name in found if name.startswith(_BLAS_OF) and found[name] != _BLAS]
    others += ["numpy"] if not {*found.get("numpy", "").split()} <= _NUMPY_LOOPS else []
    others += ["proxsuite"] if found.get("proxsuite", "avx2").removeprefix("proxsuite_pywrap_") != "avx2" else []
    cause = f"{UNPINNED}=unpinned" if _is_unpinned(os.environ) else "it was loaded before"
    texts = [f"{name} uses {found[name]}" for name in others]
    return f"{', '.join(texts)} ({cause}): {_NOT_PINNED}" if others else ""
