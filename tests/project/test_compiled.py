"""Machine code on disk is used as long as all that it follows from is the same, and no longer."""

import importlib
import shutil
import sys

import pytest

from vehicle_sim.app.compile_kernels import compile_kernels

MODULES = {
    "__init__": "",
    "constants": "OFFSET = 10.0\nWIDTHS = (0.0, 100.0)\n",
    "functions": "def longer(x):\n    return 2.0 * x\n",
    "length_kernels": """
from idc_controller.compiled import inlined, kernel
from lengths import constants, functions
from lengths.constants import OFFSET

_longer = inlined(functions.longer)


@kernel
def length(x: float) -> float:
    return _longer(x) + OFFSET + constants.WIDTHS[1]
""",
}


@pytest.fixture
def imported(tmp_path, monkeypatch):
    """Import the kernel of a small package from a folder of that name, as another process would."""
    monkeypatch.setattr("numba.core.config.CACHE_DIR", str(tmp_path / "cache"))
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.setattr("idc_controller.uncompiled.compile_all", None)  # as a flight in this process has set it

    def load(checkout="first", **changed):
        package = tmp_path / checkout / "lengths"
        package.mkdir(parents=True, exist_ok=True)
        for name, text in (MODULES | changed).items():
            (package / f"{name}.py").write_text(text)
        for name in [name for name in sys.modules if name.partition(".")[0] == "lengths"]:
            monkeypatch.delitem(sys.modules, name)
        importlib.invalidate_caches()
        with monkeypatch.context() as path:
            path.syspath_prepend(str(package.parent))
            return importlib.import_module("lengths.length_kernels").length

    return load


def is_compiled_anew(kernel):
    return not sum(kernel.stats.cache_hits.values())


@pytest.mark.parametrize(
    "module, before, after, result",
    [
        ("functions", "2.0 * x", "3.0 * x", 113.0),
        ("constants", "OFFSET = 10.0", "OFFSET = 20.0", 122.0),
        ("constants", "100.0", "200.0", 212.0),
        ("length_kernels", "_longer(x)", "-_longer(x)", 108.0),
    ],
)
def test_a_change_of_what_a_kernel_calls_or_names_is_followed_and_taken_back(imported, module, before, after, result):
    assert imported()(1.0) == 112.0
    assert imported(**{module: MODULES[module].replace(before, after)})(1.0) == result
    assert not is_compiled_anew(length := imported())
    assert length(1.0) == 112.0


def test_another_checkout_compiles_nothing(imported):
    assert is_compiled_anew(imported())
    other = imported("second", length_kernels="# Moved by a line.\n" + MODULES["length_kernels"])
    assert not is_compiled_anew(other)
    assert other(1.0) == 112.0


def test_all_kernels_are_compiled_when_the_first_is_not_on_disk(imported, tmp_path, monkeypatch):
    kept, aside = tmp_path / "cache", tmp_path / "aside"
    imported()
    kept.rename(aside)
    monkeypatch.setattr(
        "idc_controller.uncompiled.compile_all", lambda: shutil.copytree(aside, kept, dirs_exist_ok=True)
    )
    assert not is_compiled_anew(imported())
    shutil.rmtree(kept)
    assert is_compiled_anew(imported())  # once a process


def test_modules_that_cannot_be_compiled_are_named_with_their_reasons(tmp_path, monkeypatch):
    (tmp_path / "broken_kernels.py").write_text("raise TypeError('no such array')")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.setattr("vehicle_sim.app.compile_kernels._modules_of_kernels", lambda: ["broken_kernels", "json"])
    with pytest.raises(RuntimeError, match=r"(?s)^broken_kernels cannot be compiled:.*TypeError: no such array"):
        compile_kernels()
