"""The values that figures are compared with: settings, constants, functions of measures.py, and results of commands."""

from __future__ import annotations

import json
import math
import os
import re
import resource
import shutil
import statistics
import subprocess
import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field
from functools import cache
from importlib import import_module
from pathlib import Path
from typing import Any

import measures
import pandas as pd
from claims_file import MODULE, SETTINGS, Claim, ClaimsError, ClaimsFile, Figure, Source

from gcs.config import SystemConfig

ROOT = Path(__file__).parents[2]
RUNS = ROOT / "runs" / "claims"
HELPERS = {name: getattr(math, name) for name in ("degrees", "radians", "sqrt", "comb")} | {
    "median": statistics.median, "min": min, "max": max, "sum": sum, "len": len, "abs": abs, "round": round,
}  # fmt: skip


@dataclass
class Measured:
    """What the last run of a command gave: the commit, and the value of each expression that a claim has of it."""

    commit: str
    command: str
    values: dict[str, float] = field(default_factory=dict)


class Record:
    """``docs/measured.json``: the results of commands that take minutes, by source."""

    def __init__(self, path: Path) -> None:
        self._path = path
        read = json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}
        self.measured = {name: Measured(**entry) for name, entry in read.items()}

    def lacks(self, source: Source, expressions: Iterable[str]) -> bool:
        """Return whether the command has changed since, or not all the expressions were recorded."""
        entry = self.measured.get(source.name)
        return entry is None or entry.command != source.command or not entry.values.keys() >= set(expressions)

    def write(self) -> None:
        """Write the file, one line a value."""
        entries = {name: asdict(entry) for name, entry in sorted(self.measured.items())}
        self._path.write_text(json.dumps(entries, indent=1, sort_keys=True) + "\n", encoding="utf-8")


class Values:
    """The values of expressions; those of commands are read from the record."""

    def __init__(self, claims: ClaimsFile, record: Record) -> None:
        self._claims = claims
        self._record = record

    def has(self, claim: Claim, figure: Figure) -> bool:
        """Return whether a figure has a value."""
        try:
            self.of(claim, figure)
        except ClaimsError:
            return False
        return True

    def of(self, claim: Claim, figure: Figure) -> float:
        """Return the value of a figure; raises :class:`ClaimsError` where there is none."""
        if self._claims.kind(claim.source) != "minutes":
            return evaluated(figure.expression, _in_process(claim.source))
        source = self._claims.sources[claim.source]
        if self._record.lacks(source, [figure.expression]):
            raise ClaimsError(f"not measured yet by the command of the claim: make claims-all ONLY={source.name}")
        return self._record.measured[source.name].values[figure.expression]


def evaluated(expression: str, namespace: Mapping[str, Any]) -> float:
    """Return the value of an expression, which may use :data:`HELPERS`."""
    try:
        return float(eval(expression, {**HELPERS, **namespace}))
    except Exception as error:
        raise ClaimsError(f"{expression} cannot be computed: {type(error).__name__}: {error}") from error


def run(source: Source, commit: str, expressions: Iterable[str]) -> Measured:
    """Run the command of a source, and return the values of expressions of its result.

    A campaign that was interrupted goes on in its folder.
    """
    folder = RUNS / re.sub(r"\W+", "-", f"{source.name} {commit}")
    if not source.result:
        shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True, exist_ok=True)
    path = f"{Path(sys.executable).parent}:{os.environ.get('PATH', '')}"
    process = subprocess.run(
        ["bash", "-euo", "pipefail", "-c", source.command], cwd=ROOT, text=True, check=False,
        stdout=None if source.result or source.pages else subprocess.PIPE,
        env=os.environ | {"OUT": str(folder), "PATH": path, "OPENBLAS_NUM_THREADS": "1"},
    )  # fmt: skip
    # Exit status 1 is a result: a flight beyond its limits, a campaign of which not all passed.
    if process.returncode > 1:
        raise ClaimsError(f"{source.name}: exit status {process.returncode} of {source.command}")
    if source.pages:
        namespace: Mapping[str, Any] = {}
    elif source.result:
        table = pd.read_csv(folder / source.result)
        namespace = {"rows": table, **{str(name): table[name] for name in table}}
    else:
        namespace = _Object(json.loads(process.stdout))
    values = {expression: evaluated(expression, namespace) for expression in sorted(set(expressions))}
    shutil.rmtree(folder)
    return Measured(commit, source.command, {name: float(f"{value:.6g}") for name, value in values.items()})


def cpu_seconds() -> float:
    """Return the CPU time of this process and of those that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(usage.ru_utime + usage.ru_stime for usage in used)


@cache
def _in_process(source: str) -> Mapping[str, Any]:
    """Return the names that expressions of settings, of a module's constants, or of a measuring function may use."""
    if source == SETTINGS:
        return vars(SystemConfig())
    if source.startswith(MODULE):
        return vars(import_module(source.removeprefix(MODULE)))
    return dict(getattr(measures, source)())


class _Object(dict[str, Any]):
    """A JSON object whose values are its attributes as well."""

    def __init__(self, content: Mapping[str, Any]) -> None:
        super().__init__({name: _Object(part) if isinstance(part, dict) else part for name, part in content.items()})

    def __getattr__(self, name: str) -> Any:
        try:
            return self[name]
        except KeyError:
            raise AttributeError(name) from None
