"""Numeric libraries that choose their code by processor: pinned to one choice, or shown to make no difference.

`make test-numerics` runs these, and the tests that touch linear algebra, with other code than the pinned one.
"""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from programs import ENVIRONMENT, gcs_fly

from gcs import numerics
from gcs.record.reader import read_table

ROOT = Path(__file__).parents[2]
ROUNDING, ROUNDING_OF_FORCE = 1e-6, 1e-5
"""Most that records (m, rad, and their rates; N) may differ by: rounding of 1e-17 may change a set-point's last bit.

That is in single precision: 2e-6 N of the largest thrust, fivefold grown by gains.
"""


@pytest.fixture
def features(monkeypatch):
    """The instruction sets of a processor, to be set."""

    def has(*names):
        monkeypatch.setattr(numerics, "processor_features", lambda: frozenset(names))

    return has


def test_kernels_are_pinned_over_what_the_environment_names(features):
    features("avx2", "fma", "avx512f")
    environment = {"OPENBLAS_CORETYPE": "SkylakeX", "NPY_DISABLE_CPU_FEATURES": "X86_V3"}
    numerics.choose_kernels(environment)
    assert environment["OPENBLAS_CORETYPE"] == "Haswell"
    assert "NPY_DISABLE_CPU_FEATURES" not in environment
    assert "AVX512" not in environment["NPY_ENABLE_CPU_FEATURES"]


@pytest.mark.parametrize("has", [("sse4_2", "avx"), ("avx2",), ()])
def test_processor_without_the_pinned_code_keeps_its_own_and_is_named(features, has):
    features(*has)
    environment = {"OPENBLAS_CORETYPE": "Nehalem"}
    numerics.choose_kernels(environment)
    assert environment["OPENBLAS_CORETYPE"] == "Nehalem" and "NPY_ENABLE_CPU_FEATURES" not in environment
    assert environment["OPENBLAS_NUM_THREADS"] == "1"
    assert "lacks AVX2 and FMA" in numerics.differences()


def test_unpinned_environment_is_left_as_it_is(features):
    features("avx2", "fma")
    environment = {"COOPLIFT_KERNELS": "unpinned", "OPENBLAS_CORETYPE": "Nehalem"}
    numerics.choose_kernels(environment)
    assert environment["OPENBLAS_CORETYPE"] == "Nehalem" and "NPY_ENABLE_CPU_FEATURES" not in environment


@pytest.mark.parametrize(
    "found, text",
    [
        ({"BLAS of numpy": "openblas SkylakeX", "BLAS of scipy": "openblas Haswell"}, "BLAS of numpy uses openblas"),
        ({"BLAS of numpy": "mkl"}, "BLAS of numpy uses mkl"),
        ({"numpy": "X86_V3 X86_V4 AVX512_ICL"}, "numpy uses X86_V3 X86_V4"),
        ({"proxsuite": "proxsuite_pywrap_avx512"}, "proxsuite uses proxsuite_pywrap_avx512"),
    ],
)
def test_libraries_loaded_before_with_other_code_are_named(features, monkeypatch, found, text):
    features("avx2", "fma")
    monkeypatch.delenv(numerics.UNPINNED, raising=False)
    monkeypatch.setattr(numerics, "numerics", lambda: found)
    assert text in numerics.differences() and "(it was loaded before)" in numerics.differences()


def test_pinned_code_is_no_difference(features, monkeypatch):
    features("avx2", "fma")
    found = {"BLAS of numpy": "openblas Haswell", "numpy": "X86_V3", "proxsuite": "proxsuite_pywrap_avx2"}
    monkeypatch.setattr(numerics, "numerics", lambda: found)
    assert numerics.differences() == ""


def test_proxsuite_leaves_its_build_for_avx512_out():
    import idc_controller.qp  # noqa: F401

    with pytest.raises(ModuleNotFoundError):
        __import__("proxsuite.proxsuite_pywrap_avx512")


_DISTANCES = """
import sys
import numpy as np
from bodies import EXAMPLES
from idc_controller.geometry.obstacles import Bodies
rng = np.random.default_rng(1)
distances = Bodies(EXAMPLES).distance(5.0 * rng.normal(size=(500, 3)), rng.normal(size=(len(EXAMPLES), 3)))
sys.stdout.buffer.write(distances.tobytes())
"""


@pytest.mark.slow
@pytest.mark.long  # part of CI by make test-numerics
@pytest.mark.numerics
def test_kernels_of_numba_give_the_same_bytes_for_every_processor(tmp_path):
    def distances(**variables):
        environment = {**ENVIRONMENT, "PYTHONPATH": f"{ROOT}{os.pathsep}{ROOT / 'tests' / 'support'}", **variables}
        return subprocess.run(
            [sys.executable, "-c", _DISTANCES], env=environment, capture_output=True, check=True
        ).stdout

    first = {"NUMBA_CPU_NAME": "x86-64", "NUMBA_CPU_FEATURES": "", "NUMBA_CACHE_DIR": str(tmp_path)}  # SSE2 alone
    assert len(distances()) and distances(**first) == distances()


@pytest.mark.slow
@pytest.mark.long  # part of CI by make test-numerics, with the kernels that make a difference
@pytest.mark.numerics
def test_flight_with_other_kernels_differs_by_rounding_only(tmp_path, monkeypatch):
    for name in ("pinned", "unpinned"):
        monkeypatch.setitem(ENVIRONMENT, numerics.UNPINNED, name)
        code, summary = gcs_fly(ROOT / "missions" / "hop.toml", tmp_path / name, "--seed", "5", "--no-pictures")
        assert code == 0, summary
    for table in ("truth.csv", "estimate.csv"):
        one, other = (read_table(tmp_path / name / table) for name in ("pinned", "unpinned"))
        assert one.dtype == other.dtype
        for column in one.dtype.names:
            bound = ROUNDING_OF_FORCE if "_n_" in f"{column}_" else ROUNDING
            np.testing.assert_allclose(one[column], other[column], rtol=0.0, atol=bound)
