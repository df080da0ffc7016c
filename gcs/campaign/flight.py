"""One flight of a campaign: its plan, and the call that flies it in a process of the campaign's executor."""

import hashlib
import json
import os
import secrets
import shlex
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Any

import gcs
from gcs.campaign.folder import digest, remove_folder, shown
from gcs.campaign.result import Flown, Result, summary_columns
from gcs.errors import GcsError, UnusableInput
from gcs.mission.read import read_mission
from gcs.record.incomplete import INCOMPLETE
from gcs.record.run_folder import MANIFEST, to_json

DONE, OUTSIDE_LIMITS, UNUSABLE = 0, 1, 2
"""Exit statuses of ``gcs fly``."""
_ONE_AT_A_TIME = threading.Lock()
"""A worker of a cluster may carry out calls in several threads: its flights would only delay each other."""


PACKAGES = ("gcs", "idc_controller", "vehicle_sim")


@cache
def code_digest() -> str:
    """Return a text that is another for other sources of the packages."""
    root, found = Path(gcs.__file__).parents[1], hashlib.sha256()
    for path in sorted(path for package in PACKAGES for path in (root / package).rglob("*.py")):
        found.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes())
    return found.hexdigest()[:16]


def verdict_key(mission: Path, config: Path | None, *options: str) -> str:
    """Return a text that is another for another code, mission with its system and seed, or for other options."""
    try:
        as_read = json.dumps(to_json(replace(read_mission(mission, config), path=Path())))
    except GcsError as error:  # as it will be refused
        as_read = str(error)
    return digest(code_digest(), as_read, *options)


@dataclass(frozen=True)
class FlightPlan:
    """One flight: the arguments of :func:`gcs.fly`, with absolute paths, and how the flight is judged.

    ``labels`` are columns of its result that are known before the flight, ``files`` are written before it; ``judge``
    returns the columns that follow from how it ended and from its run folder, ``failures`` and ``outcome`` among them.
    ``fly`` flies and judges it in place of :func:`gcs.fly`.
    """

    number: int
    name: str
    mission: Path
    judge: Callable[["FlightPlan", Flown, Path], Mapping[str, Any]]
    controller: str = "idc"
    config: Path | None = None
    seed: int | None = None
    settings: Mapping[str, Any] = field(default_factory=dict)
    labels: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[Path, str] = field(default_factory=dict)
    fly: Callable[["FlightPlan"], Result] | None = None

    @property
    def key(self) -> str:
        """Text that is another where code, mission, seed or options are, by which its result is kept."""
        options = [self.controller, *([] if self.seed is None else [str(self.seed)]), *self._settings]
        return verdict_key(self.mission, self.config, *options)

    @property
    def replay(self) -> str:
        """The command that repeats the flight."""
        words = ["gcs", "fly", str(shown(self.mission)), "--controller", self.controller]
        words += [] if self.config is None else ["--config", str(shown(self.config))]
        words += [] if self.seed is None else ["--seed", str(self.seed)]
        return shlex.join([*words, *(word for setting in self._settings for word in ("--set", setting))])

    @property
    def _settings(self) -> list[str]:
        """The settings as ``--set`` takes them."""
        return [f"{path}={json.dumps(value)}" for path, value in self.settings.items()]

    def result(self, flown: Flown, run_dir: Path) -> Result:
        """Judge the flight."""
        columns = {**summary_columns(flown), **self.judge(self, flown, run_dir)}
        return Result(**columns, run_dir=str(run_dir) if run_dir.exists() else "")


def fly_plan(plan: FlightPlan, folder: Path) -> Result:
    """Fly in this process, and judge the flight; its run folder is a hidden one in ``folder``, named in the result.

    Raises :class:`GcsError` where there is no ``folder``.
    """
    if not folder.is_dir():
        raise GcsError(f"{folder}: not found by a worker, which must share the file system of this machine")
    run_dir = folder / f".{plan.name}-{os.getpid()}-{secrets.token_hex(4)}"
    with _ONE_AT_A_TIME:
        if plan.fly is not None:
            return plan.fly(plan)
        flown = fly(plan, run_dir)
    if not (run_dir / MANIFEST).exists():  # the campaign has been interrupted, and has removed it
        remove_folder(run_dir)
    return plan.result(flown, run_dir)


def fly(plan: FlightPlan, run_dir: Path) -> Flown:
    """Fly in this process; whatever goes wrong is a reason."""
    begin = time.monotonic()
    summary: Mapping[str, Any] = {}
    try:
        flight = gcs.fly(
            plan.mission, seed=plan.seed, config=plan.config, settings=plan.settings, controller=plan.controller,
            run_dir=run_dir,
        )  # fmt: skip
    except UnusableInput as error:
        # The same text wherever the campaign is.
        exit_code, reason = UNUSABLE, str(error).replace(f"{plan.mission.parent}/", "")
    except Exception as error:
        exit_code, reason = OUTSIDE_LIMITS, f"{type(error).__name__}: {error}"
    else:
        summary, reason = flight.figures, flight.reason
        exit_code = INCOMPLETE if flight.incomplete else DONE if flight.within_limits else OUTSIDE_LIMITS
    return Flown(exit_code, summary, reason, time.monotonic() - begin)
