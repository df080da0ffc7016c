"""Machine code on disk is used as long as all that it follows from is the same, and no longer."""

import importlib
import os
import subprocess
import sys
from pathlib import Path

import pytest

from vehicle_sim.app.compile_kernels import compile_kernels

ROOT = Path(__file__).parents[1]

KERNELS = """
from idc_controller.compiled import inlined, kernel
from lengths import constants, functions
from lengths.constants import OFFSET

_longer = inlined(functions.longer)


@inlined
def moved(x, by=1.0):
    return x + by


@kernel("float64(float64)")
def length(x):
    return moved(_longer(x)) + OFFSET + constants.WIDTHS[1]
"""
CALLING_KERNELS = """
from idc_controller.compiled import kernel
from lengths.length_kernels import length


@kernel("float64(float64, float64)")
def area(x, y):
    return length(x) * length(y) + FACTOR
"""
SUM = """
from idc_controller.compiled import kernel


@kernel("float64[::1](float64[::1], float64[::1])")
def sums(a, b):
    return a + b
"""
CONSTANTS = "OFFSET = 10.0\nWIDTHS = (0.0, 100.0)\n"
FUNCTIONS = "def longer(x):\n    return 2.0 * x\n"


@pytest.fixture
def imported(tmp_path, monkeypatch):
    """Import the kernels of a small package anew, as another process would."""
    package = tmp_path / "lengths"
    package.mkdir()
    for name, text in {
        "__init__": "",
        "length_kernels": KERNELS,
        "constants": CONSTANTS,
        "functions": FUNCTIONS,
    }.items():
        (package / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)

    def load():
        for name in [name for name in sys.modules if name.partition(".")[0] == "lengths"]:
            del sys.modules[name]
        importlib.invalidate_caches()
        return importlib.import_module("lengths.length_kernels").length

    yield load
    for name in [name for name in sys.modules if name.partition(".")[0] == "lengths"]:
        del sys.modules[name]


@pytest.fixture
def imported_caller(imported, tmp_path):
    """Import a kernel that calls another one, with another constant in it each time."""

    def load(factor):
        text = CALLING_KERNELS.replace("FACTOR", repr(factor))
        (tmp_path / "lengths" / "calling_kernels.py").write_text(text)
        imported()
        importlib.invalidate_caches()
        return importlib.import_module("lengths.calling_kernels")

    return load


def is_compiled_anew(kernel):
    return not sum(kernel.stats.cache_hits.values())


def test_machine_code_is_kept(imported):
    assert is_compiled_anew(imported())
    assert not is_compiled_anew(length := imported())
    assert length(1.0) == 113.0


@pytest.mark.parametrize(
    "module, before, after, result",
    [
        ("functions", "2.0 * x", "3.0 * x", 114.0),
        ("constants", "OFFSET = 10.0", "OFFSET = 20.0", 123.0),
        ("constants", "100.0", "200.0", 213.0),
        ("length_kernels", "by=1.0", "by=2.0", 114.0),
        ("length_kernels", "x + by", "x - by", 111.0),
    ],
)
def test_a_change_of_what_a_kernel_calls_or_names_is_followed_and_taken_back(
    imported, tmp_path, module, before, after, result
):
    assert imported()(1.0) == 113.0
    path = tmp_path / "lengths" / f"{module}.py"
    source, stamps = path.read_text(), path.stat()
    path.write_text(source.replace(before, after))
    os.utime(path, ns=(stamps.st_atime_ns, stamps.st_mtime_ns))
    assert imported()(1.0) == result
    path.write_text(source)
    assert not is_compiled_anew(length := imported())
    assert length(1.0) == 113.0


def test_a_kernel_from_disk_is_compiled_into_one_that_calls_it(imported_caller):
    assert imported_caller(1.0).area(1.0, 2.0) == 113.0 * 115.0 + 1.0
    module = imported_caller(2.0)
    assert is_compiled_anew(module.area)
    assert not is_compiled_anew(module.length)
    assert module.area(1.0, 2.0) == 113.0 * 115.0 + 2.0


@pytest.mark.slow
def test_a_kernel_from_disk_imports_nothing_to_compile_with_and_still_names_arrays_that_do_not_fit(tmp_path):
    (tmp_path / "sum_kernels.py").write_text(SUM)
    program = (
        "import sys, numpy as np; from sum_kernels import sums\n"
        "print(sum(sums.stats.cache_hits.values()), 'numba.np.arrayobj' in sys.modules, sums(np.ones(2), np.ones(2)))\n"
        "try: sums(np.ones(2), np.ones(3))\n"
        "except ValueError as error: print(error)"
    )
    environment = {**os.environ, "PYTHONPATH": f"{tmp_path}:{ROOT}"}
    compiled, loaded = (
        subprocess.run([sys.executable, "-c", program], env=environment, check=True, capture_output=True, text=True)
        for _ in range(2)
    )
    assert compiled.stdout.startswith("0 True [2. 2.]")
    assert loaded.stdout.startswith("1 False [2. 2.]")
    assert "unable to broadcast" in loaded.stdout


def test_a_change_of_something_else_compiles_nothing(imported, tmp_path):
    imported()
    for module in ("constants", "functions", "length_kernels"):
        with (tmp_path / "lengths" / f"{module}.py").open("a") as file:
            file.write("\nUNUSED = 1.0  # a comment\n")
    assert not is_compiled_anew(imported())


def test_a_package_that_cannot_be_written_is_cached_for_the_user(imported, tmp_path, monkeypatch):
    (tmp_path / "lengths" / "__pycache__").write_text("no folder")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    assert is_compiled_anew(imported())
    assert list((tmp_path / "user").rglob("*.nbc"))
    assert not is_compiled_anew(imported())


def test_modules_that_cannot_be_compiled_are_named_with_their_reasons(tmp_path, monkeypatch):
    (tmp_path / "first_broken_kernels.py").write_text("raise TypeError('no such array')")
    (tmp_path / "second_broken_kernels.py").write_text("import absent_module")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr(
        "vehicle_sim.app.compile_kernels._modules_of_kernels",
        lambda: ["first_broken_kernels", "json", "second_broken_kernels"],
    )
    with pytest.raises(RuntimeError) as failure:
        compile_kernels()
    first, second = str(failure.value).split("second_broken_kernels cannot be compiled:\n")
    assert first.startswith("first_broken_kernels cannot be compiled:\nTraceback")
    assert "TypeError: no such array" in first
    assert "No module named 'absent_module'" in second


@pytest.mark.slow
def test_programs_compile_nothing_after_installation():
    assert compile_kernels()
    program = (
        "import gc; from numba.core.dispatcher import Dispatcher; import gcs.app.fly, vehicle_sim.app.launch\n"
        "kernels = [d for d in gc.get_objects() if isinstance(d, Dispatcher) and d.__module__.endswith('kernels')]\n"
        "cached = [d for d in kernels if not d._can_compile]\n"
        "print(len(cached), [d.__name__ for d in cached if sum(d.stats.cache_misses.values())])"
    )
    environment = {**os.environ, "PYTHONHASHSEED": "1"}
    output = subprocess.run([sys.executable, "-c", program], cwd=ROOT, env=environment, check=True, capture_output=True)
    number, compiled = output.stdout.decode().splitlines()[-1].split(" ", 1)
    assert int(number) > 20
    assert compiled == "[]"
