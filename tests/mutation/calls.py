"""The map of which test file calls which function, recorded once; the choice of tests for a mutant from it."""

from __future__ import annotations

import ast
import hashlib
import json
import os
import sys
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Set
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from operators import Mutant

PACKAGES = ("gcs", "idc_controller", "vehicle_sim")
Call = tuple[str, str]
"""Path of a module and qualified name of a function, as code objects have it."""


def cpu_seconds() -> float:
    """Return this process's CPU time, that of its ended children too."""
    spent = os.times()
    return spent.user + spent.system + spent.children_user + spent.children_system


class CallRecorder:
    """A plugin of pytest that records the calls and the CPU time (s) of every test."""

    def __init__(self, root: Path) -> None:
        self.root = f"{root}/"
        self.calls: dict[str, set[Call]] = defaultdict(set)
        self.cost: dict[str, float] = {}

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        """Record a test with its fixtures."""
        seen: set[Any] = set()
        begin = cpu_seconds()
        sys.settrace(lambda frame, event, argument: seen.add(frame.f_code))
        try:
            return (yield)
        finally:
            sys.settrace(None)
            self.cost[item.nodeid] = cpu_seconds() - begin
            for code in seen:
                path = code.co_filename.removeprefix(self.root)
                if path.startswith(PACKAGES):
                    self.calls[item.nodeid].add((path, code.co_qualname.replace("<locals>.", "")))


@dataclass(frozen=True)
class TestFile:
    """A test file whose tests may notice a mutant, in the order in which they are run."""

    __test__ = False  # no class of tests
    name: str
    tests: list[str]
    cost: float
    """CPU time (s) of all."""
    share: float
    """Part of its tests that call the mutated function."""


@dataclass
class CallMap:
    """Calls and cost of all tests, kept in a file; a test file that changed is recorded anew."""

    file: Path
    tests: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Per test file: its checksum, and per test [CPU time (s), calls]."""

    @classmethod
    def read(cls, file: Path) -> CallMap:
        """Read the map that an earlier run has left."""
        return cls(file, json.loads(file.read_text()) if file.exists() else {})

    def update(self, root: Path, record: Callable[[list[str]], Iterable[CallRecorder]]) -> None:
        """Record the test files that are new or changed, and forget those that are gone."""
        checksums = {
            str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest()
            for path in sorted(root.glob("tests/test_*.py"))
        }
        self.tests = {name: known for name, known in self.tests.items() if checksums.get(name) == known["sha256"]}
        missing = sorted(checksums.keys() - self.tests.keys())
        self.file.parent.mkdir(parents=True, exist_ok=True)
        for name, recorder in zip(missing, record(missing), strict=True):
            calls = {test: [cost, sorted(recorder.calls[test])] for test, cost in recorder.cost.items()}
            self.tests[name] = {"sha256": checksums[name], "tests": calls}
            self.file.write_text(json.dumps(self.tests))

    def tests_for(self, mutant: Mutant, importers: dict[str, set[str]]) -> list[TestFile]:
        """Return the test files that may notice the mutant, those first of which most tests call the function.

        What is no function (a constant, a default), what is compiled (a kernel) and what is newer than the map may be
        noticed by whoever calls the module or one that imports it, and by tests that import one of these: calls of
        kernels are not seen.
        """
        if mutant.function and not mutant.path.endswith("kernels.py"):
            found = self._calling(lambda path, name: path == mutant.path and _encloses(name, mutant.function))
            if found:
                return found
        modules = users(mutant.path, importers)
        return self._calling(lambda path, name: path in modules, importing=modules)

    def _calling(self, is_called: Callable[[str, str], bool], importing: Set[str] = frozenset()) -> list[TestFile]:
        """Return the files with tests that call what ``is_called`` says, and those ``importing``."""
        found = []
        for name, entry in self.tests.items():
            callers, others = [], []
            for test, (cost, calls) in entry["tests"].items():
                is_caller = name in importing or any(is_called(*call) for call in calls)
                (callers if is_caller else others).append((cost, test))
            if callers:
                # The others run last: a fixture that they share with the callers may have been recorded as a caller's.
                tests = [*sorted(callers), *sorted(others)]
                share = len(callers) / len(tests)
                found.append(TestFile(name, [test for _, test in tests], sum(cost for cost, _ in tests), share))
        return sorted(found, key=lambda file: (-file.share, file.cost))


def _encloses(function: str, scope: str) -> bool:
    """Return whether a call of ``function`` may reach the scope: itself, what it encloses, or its class's body."""
    return scope == function or function.startswith(f"{scope}.") or scope.startswith(f"{function}.")


def import_graph(root: Path) -> dict[str, set[str]]:
    """Return, per module's path, the paths of the modules that import it."""
    importers: dict[str, set[str]] = defaultdict(set)
    for package in (*PACKAGES, "tests"):
        for path in root.glob(f"{package}/**/*.py"):
            for node in ast.walk(ast.parse(path.read_text())):
                if isinstance(node, ast.ImportFrom) and (node.module or "").startswith(PACKAGES):
                    for name in (node.module, *(f"{node.module}.{alias.name}" for alias in node.names)):
                        importers[f"{str(name).replace('.', '/')}.py"].add(str(path.relative_to(root)))
                        importers[f"{str(name).replace('.', '/')}/__init__.py"].add(str(path.relative_to(root)))
    return importers


def users(path: str, importers: dict[str, set[str]]) -> set[str]:
    """Return a module and those that import it, through packages' exports and other modules of kernels too."""
    found, left = {path}, [path]
    while left:
        for user in importers.get(left.pop(), ()):
            if user not in found:
                found.add(user)
                if user.endswith(("__init__.py", "kernels.py")):
                    left.append(user)
    return found
