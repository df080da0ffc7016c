"""Run the fast tests against a sample of mutants of the flight path: changes that a test must notice.

  python tests/mutation/mutants.py                              60 mutants, seed 1
  python tests/mutation/mutants.py --number 100 --seed 2
  python tests/mutation/mutants.py --number 20 --skip 40        the last third of a sample of 60 alone
  python tests/mutation/mutants.py --module gcs/flight          of these modules only (repeatable)
  python tests/mutation/mutants.py --list                       list the sample, run nothing

Each is applied in a copy of the tree and run there with the fast tests that call the changed function, until one fails.
(A map of calls is recorded at the first run, and again for test files that change.) Survivors are listed; those that
`equivalent.toml` names cannot be noticed. Exit status 1 when fewer than 85 % of the others are killed.
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import shutil
import sys
import tempfile
import tomllib
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass
from importlib import import_module
from itertools import islice
from multiprocessing import get_context
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE))

import pytest  # noqa: E402
from calls import PACKAGES, Call, CallMap, CallRecorder, TestFile, cpu_seconds, import_graph  # noqa: E402
from operators import Mutant, mutants_of  # noqa: E402

FLIGHT_PATH = (
    "idc_controller/", "gcs/flight/", "gcs/mavlink/", "gcs/drivers/", "gcs/mission/compile.py", "gcs/mission/motion.py",
    "gcs/mission/route.py", "vehicle_sim/autopilot/", "vehicle_sim/faults/", "vehicle_sim/mavlink/",
    "vehicle_sim/world/",
)  # fmt: skip
NOT_FLOWN = (
    "idc_controller/paper/", "idc_controller/compiled.py", "idc_controller/settings.py", "gcs/flight/listing.py",
    "vehicle_sim/world/display.py",
)  # fmt: skip
CALL_MAP = ROOT / ".pytest_cache" / "mutants" / "calls.json"
COPIED = (*PACKAGES, "tests", "missions", "docs", "README.md", "CONTRIBUTING.md", "CHANGELOG.md", "NOTICE", "Makefile",
          "pyproject.toml", "constraints.txt")  # fmt: skip
WANTED = 0.85
FIRST_FILES = 3  # run before the others are collected
PASSED = (pytest.ExitCode.OK, pytest.ExitCode.NO_TESTS_COLLECTED)
WALL_TIME_LIMIT = 1200.0  # s, for a mutant that waits for ever
SETTLING = 60.0  # s of CPU for imports and compilation of kernels, added to five times what the tests cost
WARM = ("numpy", "scipy.linalg", "scipy.optimize", "hypothesis", "pybullet", "pymavlink.dialects.v20.common",
        "pydantic", "shapely", "trimesh", "coal", "proxsuite", "daqp", "filterpy.kalman", "rich.progress")  # fmt: skip


@dataclass(frozen=True)
class Outcome:
    """End of a mutant: the test that failed, or what else ended it; None: it survived."""

    mutant: Mutant
    killed_by: str | None
    cpu: float


class FirstFailure:
    """A plugin of pytest that runs the tests in the order of their list and keeps the first that fails."""

    def __init__(self, order: Sequence[str]) -> None:
        self.order = {test: place for place, test in enumerate(order)}
        self.failed: str | None = None

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Sort, and leave out what is not in the list."""
        items[:] = sorted(
            (item for item in items if item.nodeid in self.order), key=lambda item: self.order[item.nodeid]
        )

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep the first failure."""
        if report.failed and self.failed is None:
            self.failed = report.nodeid

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        """Count a module that cannot be imported as a failure."""
        if report.failed and self.failed is None:
            self.failed = f"import of {report.nodeid}"


def run_pytest(tree: Path, plugin: object, *arguments: str) -> int:
    """Run pytest in this process on a copy of the tree."""
    os.chdir(tree)
    sys.path[:0] = [str(tree)]
    sys.dont_write_bytecode = True
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, 1), os.dup2(null, 2)
    quiet = ("-q", "-x", "-p", "no:cacheprovider", "-p", "no:xdist", "-m", "not slow and not long", "-o", "addopts=")
    status = pytest.main([*quiet, "--strict-markers", *arguments], plugins=[plugin])
    import gcs

    if not gcs.__file__.startswith(str(tree)):
        raise RuntimeError(f"tested {gcs.__file__}, not {tree}")
    return int(status)


def in_child(target: Callable[[], Any]) -> Any:
    """Return what a function returns in a forked process, or a word on how that ended without."""
    context = get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    process = context.Process(target=lambda: sender.send(target()))
    process.start()
    sender.close()
    try:
        return receiver.recv() if receiver.poll(WALL_TIME_LIMIT) else "no end"
    except EOFError:
        return "process ended"
    finally:
        process.kill()
        process.join()


def record_calls(tree: Path, file: str) -> CallRecorder:
    """Run a test file of an unchanged copy and record its calls."""

    def record() -> tuple[int, dict[str, set[Call]], dict[str, float]]:
        recorder = CallRecorder(tree)
        return run_pytest(tree, recorder, file), dict(recorder.calls), recorder.cost

    answer = in_child(record)
    if not isinstance(answer, tuple) or answer[0] not in PASSED:
        raise RuntimeError(f"{file} fails without a mutant: mend it first")
    recorded = CallRecorder(tree)
    recorded.calls.update(answer[1])
    recorded.cost.update(answer[2])
    return recorded


def run_mutant(tree: Path, mutant: Mutant, files: list[TestFile]) -> Outcome:
    """Run test files on a copy of the tree with the mutant applied; the copy is restored."""
    module = tree / mutant.path
    source, stamps = module.read_bytes(), module.stat()
    begin = cpu_seconds()
    try:
        module.write_bytes(mutant.apply(source))
        for few in (files[:FIRST_FILES], files[FIRST_FILES:]):
            killed_by = in_child(lambda few=few: first_failure(tree, few)) if few else None
            if killed_by is not None:
                break
    finally:
        module.write_bytes(source)
        os.utime(module, ns=(stamps.st_atime_ns, stamps.st_mtime_ns))
    return Outcome(mutant, killed_by, cpu_seconds() - begin)


def first_failure(tree: Path, files: list[TestFile]) -> str | None:
    """Return the first test that fails; this process is limited in its CPU time."""
    limit = int(SETTLING + 5.0 * sum(file.cost for file in files))
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    first = FirstFailure([test for file in files for test in file.tests])
    status = run_pytest(tree, first, *(file.name for file in files))
    return first.failed or (None if status in PASSED else f"pytest ended with {status}")


class Worker:
    """What a worker process has: a copy of the tree of its own, and the packages that the tests need, imported."""

    tree: Path

    @classmethod
    def prepare(cls, folder: Path) -> None:
        """Copy the tree, with its compiled modules and their times, into a folder of this process."""
        for name in WARM:
            import_module(name)
        cls.tree = folder / str(os.getpid())
        cls.tree.mkdir()
        for name in COPIED:
            if (ROOT / name).is_dir():
                shutil.copytree(ROOT / name, cls.tree / name)
            else:
                shutil.copy2(ROOT / name, cls.tree / name)

    @classmethod
    def record(cls, file: str) -> CallRecorder:
        """Record the calls of a test file."""
        return record_calls(cls.tree, file)

    @classmethod
    def run(cls, mutant: Mutant, files: list[TestFile]) -> Outcome:
        """Run the tests against a mutant."""
        return run_mutant(cls.tree, mutant, files)


def equivalents() -> set[tuple[str, str, str]]:
    """Return path, line and replacement of the mutants that cannot be noticed."""
    named = tomllib.loads((HERE / "equivalent.toml").read_text())
    return {(entry["path"], entry["line"], entry["replacement"]) for entry in named["equivalent"]}


def sample(modules: Sequence[str], number: int, seed: int) -> list[Mutant]:
    """Draw mutants of all those of the modules, none twice."""
    everything = [
        mutant
        for package in PACKAGES
        for path in sorted(ROOT.glob(f"{package}/**/*.py"))
        if (name := str(path.relative_to(ROOT))).startswith(tuple(modules))
        and not name.startswith(NOT_FLOWN)
        and path.name != "settings.py"  # values to choose, not behaviour
        for mutant in mutants_of(name, path.read_text())
    ]
    random.Random(seed).shuffle(everything)
    return list(
        islice((mutant for mutant in everything if mutant.is_python((ROOT / mutant.path).read_bytes())), number)
    )


def report(outcomes: Sequence[Outcome]) -> bool:
    """Print the survivors and the share of killed mutants; return whether it is as large as wanted."""
    known = equivalents()
    survivors = [outcome.mutant for outcome in outcomes if outcome.killed_by is None]
    equivalent = [m for m in survivors if (m.path, m.text, m.replacement) in known]
    alive = sorted((m for m in survivors if m not in equivalent), key=lambda m: (m.path, m.line))
    noticeable = len(outcomes) - len(equivalent)
    share = 1.0 - len(alive) / noticeable if noticeable else 1.0
    print(f"\n{len(outcomes)} mutants, {len(equivalent)} of them equivalent: {share:.0%} of the others killed "
          f"(wanted: {WANTED:.0%}); {sum(outcome.cpu for outcome in outcomes):.0f} s of CPU")  # fmt: skip
    for mutant in alive:
        print(f"survived  {mutant}")
    return share >= WANTED


def main() -> int:
    """Run the command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--number", type=int, default=60, help="mutants to draw (default: %(default)s)")
    parser.add_argument("--seed", type=int, default=1, help="of the sample (default: %(default)s)")
    parser.add_argument("--skip", type=int, default=0, help="mutants of the sample to leave out, the first ones")
    parser.add_argument("--module", action="append", help="path, or begin of a path, to draw from; repeatable")
    parser.add_argument(
        "--jobs", type=int, default=min(2, os.cpu_count() or 1), help="processes (default: %(default)s)"
    )
    parser.add_argument("--list", action="store_true", help="list the sample and run nothing")
    options = parser.parse_args()
    mutants = sample(options.module or FLIGHT_PATH, options.skip + options.number, options.seed)[options.skip :]
    if options.list:
        print(*mutants, sep="\n")
        return 0
    importers = import_graph(ROOT)
    with (
        tempfile.TemporaryDirectory(prefix="mutants-") as folder,
        ProcessPoolExecutor(options.jobs, get_context("fork"), Worker.prepare, (Path(folder),)) as pool,
    ):
        calls = CallMap.read(CALL_MAP)
        calls.update(ROOT, lambda files: pool.map(Worker.record, files))
        running = [pool.submit(Worker.run, mutant, calls.tests_for(mutant, importers)) for mutant in mutants]
        outcomes = []
        for future in as_completed(running):
            outcomes.append(outcome := future.result())
            print(f"[{len(outcomes)}/{len(mutants)}] {outcome.mutant}\n    "
                  f"{outcome.killed_by or 'SURVIVED'} ({outcome.cpu:.1f} s)", flush=True)  # fmt: skip
    return 0 if report(outcomes) else 1


if __name__ == "__main__":
    sys.exit(main())
