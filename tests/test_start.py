"""The start of the commands: which modules they import. What takes long to import, only a flight may need."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[1]
FOR_NUMBERS = {"numpy", "pydantic"}
FOR_FLIGHTS = {
    "coal", "daqp", "filterpy", "matplotlib", "numba", "pandas", "proxsuite", "pyarrow", "pybullet", "pymap3d",
    "pymavlink", "scipy", "shapely", "trimesh",
}  # fmt: skip
PROGRAM = """\
import sys
sys.argv = sys.argv[1:]
from importlib import import_module
try:
    status = import_module(sys.argv[0]).main()
except SystemExit as end:
    status = end.code
print("\\n", *sorted({name.partition(".")[0] for name in sys.modules}), sep=" ")
sys.exit(status)
"""


def modules_of(program: str, *arguments: str) -> set[str]:
    """Top-level modules that a command has imported when it ends."""
    command = [sys.executable, "-c", PROGRAM, program, *arguments]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True, timeout=60)
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.parametrize(
    "command",
    [
        ("gcs.app.cli", "--help"),
        ("gcs.app.cli", "fly", "--help"),
        ("gcs.app.cli", "check", "--help"),
        ("gcs.app.cli", "report", "--help"),
        ("vehicle_sim.app.cli", "--help"),
    ],
    ids=" ".join,
)
def test_help_imports_neither_numbers_nor_flight(command: tuple[str, ...]) -> None:
    assert not modules_of(*command) & (FOR_NUMBERS | FOR_FLIGHTS)


@pytest.mark.parametrize(
    ("mission", "needed"),
    [
        ("figure_eight_spheres.toml", set()),
        ("pole_course.toml", set()),
        ("delivery.plan", set()),
        ("square.waypoints", set()),
        ("fenced_delivery.plan", {"shapely"}),
    ],
)
def test_check_imports_only_what_the_mission_needs(mission: str, needed: set[str]) -> None:
    assert modules_of("gcs.app.cli", "check", f"missions/{mission}") & FOR_FLIGHTS == needed


def test_check_imports_no_kinds_of_fault_without_faults() -> None:
    script = "import sys; from gcs.mission.read import read_mission; read_mission(sys.argv[1]); print(*sys.modules)"
    command = [sys.executable, "-c", script, "missions/figure_eight_spheres.toml"]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True, timeout=60)
    imported = set(done.stdout.split())
    assert "gcs.mission.read" in imported
    assert not imported & {"gcs.faults.kinds", "gcs.mission.compile", "gcs.mission.plan", "gcs.mission.wpl"}


def test_commands_use_one_blas_thread() -> None:
    script = "import sys, threadpoolctl; from gcs.app.cli import main; main(sys.argv[1:]); import scipy.linalg\n"
    script += "print({library['num_threads'] for library in threadpoolctl.threadpool_info()})"
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    command = [sys.executable, "-c", script, "check", "missions/figure_eight.toml"]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.splitlines()[-1] == "{1}"
