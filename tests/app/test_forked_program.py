"""Programs forked in advance, and the simulated world in one: arguments, addresses, errors, and how they end."""

import gc
import itertools
import os
import signal
from pathlib import Path

import pytest

from gcs.config.flight_settings import DriverSettings
from gcs.drivers.forked_program import ForkedProgram
from gcs.drivers.simulator import Simulator
from gcs.errors import GcsError

PROGRAM = """\
import pathlib, signal, sys
kind, folder = sys.argv[-2:]
print(*sys.argv[1:], flush=True)
print("a warning", file=sys.stderr)
if kind == "refuses":
    sys.exit("port 14540 is in use")
print("clock: udp://127.0.0.1:14500\\nvehicle 1: udp://127.0.0.1:14541\\nvehicle 2: udp://10.0.0.7:14542\\nready",
      flush=True)
if kind == "killed before":
    signal.raise_signal(signal.SIGKILL)
if kind == "deaf":
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
sys.stdin.read()
if kind in ("deaf", "flies on"):
    signal.pause()
(pathlib.Path(folder) / "landed").write_text("all")
"""


@pytest.fixture
def module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """Name of a package whose program lands when its input ends, or does not, as its first argument says."""
    package = tmp_path / "scripted_world"
    package.mkdir()
    (package / "__init__.py").touch()
    (package / "__main__.py").write_text(PROGRAM)
    monkeypatch.syspath_prepend(str(tmp_path))
    return package.name


def open_descriptors() -> int:
    return len([*Path("/proc/self/fd").iterdir()])


def test_program_gets_its_arguments_and_is_waited_for_at_the_end(module: str, tmp_path: Path) -> None:
    with ForkedProgram(module) as program:
        lines = program.begin(["lands", str(tmp_path)])
        assert next(lines) == f"lands {tmp_path}\n"
        assert [next(lines) for _ in range(4)][-1] == "ready\n"
        assert program.errors() == "a warning\n" and program.process.exitcode is None
    assert (tmp_path / "landed").read_text() == "all" and program.process.exitcode == 0


def test_programs_that_have_ended_hold_no_descriptors(module: str, tmp_path: Path) -> None:
    def opened_by_one() -> int:
        with ForkedProgram(module) as program:
            lines = program.begin(["lands", str(tmp_path)])
            assert [*itertools.islice(lines, 5)][-1] == "ready\n"
        del program, lines
        gc.collect()
        return open_descriptors()

    assert opened_by_one() == opened_by_one() == opened_by_one()


def test_program_without_arguments_ends_without_running(module: str, tmp_path: Path) -> None:
    with ForkedProgram(module) as program:
        pass
    assert program.process.exitcode == 0 and not (tmp_path / "landed").exists()


def test_program_does_not_share_the_terminals_signals(module: str, tmp_path: Path) -> None:
    with ForkedProgram(module) as program:
        next(program.begin(["lands", str(tmp_path)]))
        assert os.getsid(program.process.pid) == program.process.pid


def started(module: str, kind: str, folder: Path, landing: float = 20.0, end: float = 20.0) -> Simulator:
    settings = DriverSettings(landing_timeout=landing, end_timeout=end)
    return Simulator(ForkedProgram(module), [kind, str(folder)], settings)


def test_addresses_of_the_world_are_read_and_its_records_are_closed_at_the_end(module: str, tmp_path: Path) -> None:
    with started(module, "lands", tmp_path) as world:
        assert world.clock_address == ("127.0.0.1", 14500)
        assert world.vehicles == [("127.0.0.1", 14541), ("10.0.0.7", 14542)]
        assert world.end_reason() is None
    assert (tmp_path / "landed").exists()
    assert world.end_reason() == "the simulated world has ended: vehicle-sim ended with exit code 0"


def test_world_that_does_not_start_is_refused_with_its_last_words(module: str, tmp_path: Path) -> None:
    with pytest.raises(GcsError, match=r"^vehicle-sim did not start: port 14540 is in use$"):
        started(module, "refuses", tmp_path)


@pytest.mark.parametrize(("kind", "number"), [("flies on", signal.SIGTERM), ("deaf", signal.SIGKILL)])
def test_world_that_does_not_land_is_terminated_and_then_killed(
    module: str, tmp_path: Path, kind: str, number: int
) -> None:
    world = started(module, kind, tmp_path, landing=0.05, end=0.05)
    world.close()
    assert world.end_reason() == f"the simulated world has ended: vehicle-sim was killed by signal {int(number)}"


def test_world_that_is_killed_in_flight_is_named_with_its_signal(module: str, tmp_path: Path) -> None:
    with started(module, "killed before", tmp_path) as world:
        world._process.join(20.0)
        assert world.end_reason() == "the simulated world has ended: vehicle-sim was killed by signal 9"
