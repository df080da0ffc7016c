"""The start of the commands: which modules they import. What takes long to import, only a flight may need."""

import gc
import os
import subprocess
import sys
from pathlib import Path

import pytest

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

REPOSITORY = Path(__file__).parents[1]
FOR_NUMBERS = {"numpy", "pydantic"}
FOR_FLIGHTS = {
    "coal", "daqp", "filterpy", "matplotlib", "numba", "pandas", "proxsuite", "pyarrow", "pybullet", "pymap3d",
    "pymavlink", "scipy", "shapely", "trimesh",
}  # fmt: skip
NOT_FOR_FLIGHTS = {
    "PIL", "hypothesis", "matplotlib", "pandas", "pyarrow", "pymap3d", "shapely", "trimesh",
    "gcs.faults.kinds",  # of missions with faults
    "numba.np.polynomial.polynomial_core", "numba.typed.dictimpl",  # of the registries by which numba compiles
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


def modules_of(program: str, *arguments: str, status: int = 0) -> set[str]:
    """Top-level modules that a command has imported when it ends with this exit ``status``."""
    command = [sys.executable, "-c", PROGRAM, program, *arguments]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, timeout=60)
    assert done.returncode == status, done.stderr
    return set(done.stdout.splitlines()[-1].split())


@pytest.mark.slow
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


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mission", "needed"),
    [
        ("figure_eight_spheres.toml", set()),
        ("pole_course.toml", {"numba", "scipy"}),  # a way round a pole is searched
        ("delivery.plan", set()),
        ("square.waypoints", set()),
        ("fenced_delivery.plan", {"numba", "scipy", "shapely"}),
    ],
)
def test_check_imports_only_what_the_mission_needs(mission: str, needed: set[str]) -> None:
    assert modules_of("gcs.app.cli", "check", f"missions/{mission}") & FOR_FLIGHTS == needed


@pytest.mark.slow
@pytest.mark.parametrize(
    ("mission", "options"),
    [
        ("missions/absent.toml", ()),
        ("missions/system.toml", ()),
        ("missions/figure_eight.toml", ("--config", "missions/figure_eight.toml")),
        ("missions/figure_eight.toml", ("--connect", "udp://127.0.0.1")),
        ("missions/figure_eight.toml", ("--connect", "udp://127.0.0.1:14540")),
    ],
)
def test_a_flight_with_unusable_input_imports_no_more_than_check_and_leaves_nothing(
    mission: str, options: tuple[str, ...], tmp_path: Path
) -> None:
    run_dir = tmp_path / "run"
    command = ("gcs.app.cli", "fly", mission, *options, "--run-dir", str(run_dir))
    assert not modules_of(*command, status=ExitStatus.UNUSABLE_INPUT) & FOR_FLIGHTS
    assert not run_dir.exists()


@pytest.mark.slow
def test_a_flight_imports_neither_what_draws_nor_the_compiler_of_kernels() -> None:
    script = "import sys, gcs.app.fly, vehicle_sim.app.launch; print(*sys.modules)"
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True, timeout=120)
    imported = set(done.stdout.split())
    assert {"pybullet", "numba", "scipy.linalg"} <= imported
    assert not imported & NOT_FOR_FLIGHTS


def test_imports_are_passed_over_by_collections_of_garbage() -> None:
    kept = gc.get_freeze_count()
    try:
        with importing():
            assert not gc.isenabled()
        assert gc.isenabled()
        assert gc.get_freeze_count() > kept
    finally:
        gc.unfreeze()


@pytest.mark.slow
def test_check_imports_no_kinds_of_fault_without_faults() -> None:
    script = "import sys; from gcs.mission.read import read_mission; read_mission(sys.argv[1]); print(*sys.modules)"
    command = [sys.executable, "-c", script, "missions/figure_eight_spheres.toml"]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True, timeout=60)
    imported = set(done.stdout.split())
    assert "gcs.mission.read" in imported
    assert not imported & {"gcs.faults.kinds", "gcs.mission.compile", "gcs.mission.plan", "gcs.mission.wpl"}


@pytest.mark.slow
def test_commands_use_one_blas_thread() -> None:
    script = "import sys, threadpoolctl; from gcs.app.cli import main; main(sys.argv[1:]); import scipy.linalg\n"
    script += "print({library['num_threads'] for library in threadpoolctl.threadpool_info()})"
    environment = {name: value for name, value in os.environ.items() if not name.endswith("_NUM_THREADS")}
    command = [sys.executable, "-c", script, "check", "missions/figure_eight.toml"]
    done = subprocess.run(command, cwd=REPOSITORY, capture_output=True, text=True, check=True, env=environment)
    assert done.stdout.splitlines()[-1] == "{1}"
