"""Imports run one way only: idc_controller <- gcs <- vehicle_sim, and PyBullet stays in the simulator."""

import ast
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]

FORBIDDEN = {
    # Pure mathematics: no wire, clock, log or file.
    "idc_controller": {
        "gcs", "vehicle_sim", "pybullet", "pymavlink", "socket", "socketserver", "asyncio", "select", "selectors",
        "time", "datetime", "logging", "threading", "subprocess", "pathlib", "io", "os",
    },
    "gcs": {"vehicle_sim", "pybullet"},
    "vehicle_sim": set(),
}  # fmt: skip


def imported(source):
    """Top-level names of the modules that ``source`` imports, wherever in the file it does, with the line."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from ((alias.name.split(".")[0], node.lineno) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            yield node.module.split(".")[0], node.lineno
        elif isinstance(node, ast.Call):  # import by name
            called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
            if called in ("__import__", "import_module") and node.args:
                name = node.args[0]
                if isinstance(name, ast.Constant) and isinstance(name.value, str):
                    yield name.value.split(".")[0], node.lineno


def violations(package, path, source):
    return [f"{path}:{line} imports {name}" for name, line in imported(source) if name in FORBIDDEN[package]]


@pytest.mark.parametrize("package", sorted(FORBIDDEN))
def test_imports_run_one_way(package):
    files = sorted((ROOT / package).rglob("*.py"))
    assert files
    found = [
        line for path in files for line in violations(package, path.relative_to(ROOT), path.read_text(encoding="utf-8"))
    ]
    assert not found, "\n".join(found)


def test_pybullet_is_imported_by_the_simulator_only():
    users = {
        path.relative_to(ROOT).parts[0]
        for package in FORBIDDEN
        for path in (ROOT / package).rglob("*.py")
        if "pybullet" in {name for name, _ in imported(path.read_text(encoding="utf-8"))}
    }
    assert users == {"vehicle_sim"}


@pytest.mark.parametrize(
    "source",
    [
        "import pybullet",
        "import pybullet_data as d, pybullet as p",
        "from vehicle_sim.world import World",
        "def f():\n    import vehicle_sim.world",
        "import importlib\nimportlib.import_module('vehicle_sim.world')",
    ],
)
def test_the_check_can_fail(source):
    assert violations("gcs", "x.py", source)
