"""Many random courses side by side: generated, flown on all cores, each result kept as soon as it is there."""

from __future__ import annotations

import csv
import dataclasses
import hashlib
import json
import os
import shutil
import threading
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.config import SystemConfig, read_system
from gcs.courses.flights import COLUMNS, REQUIRED, FlightPlan, Result, fly_course
from gcs.courses.generator import KINDS, generate
from gcs.errors import UnusableInput
from gcs.record.run_folder import make_folder, write_json

KEPT = ("failures", "all", "none")
SETTINGS = "campaign.json"


@dataclass(frozen=True)
class CampaignOptions:
    """What the command line of ``gcs courses`` asks for."""

    count: int
    seed: int
    out: Path
    kinds: tuple[str, ...] = KINDS
    jobs: int | None = None
    controller: str = "idc"
    config: Path | None = None
    fastest: float = 2.0
    keep: str = "failures"


class Campaign:
    """The courses of a campaign in its folder.

    ``missions/NAME.toml`` are the courses, ``flights/NAME/`` the run folders, ``results/NAME.json`` what came of
    each: a campaign that is started again goes on where it was cut off, and one of a higher count goes on with more.
    """

    def __init__(self, options: CampaignOptions) -> None:
        """Write the courses. Raises :class:`UnusableInput` for a folder of another campaign, and where it cannot."""
        self.options = options
        config = None if options.config is None else read_system(options.config)
        self._claim()
        for name in ("missions", "flights", "results"):
            make_folder(options.out / name)
        flags = ["--controller", options.controller]
        if options.config is not None:
            flags += ["--config", str(options.config)]
        self._plans = [self._plan(number, tuple(flags), config) for number in range(1, options.count + 1)]
        self.results: list[Result] = [
            result for plan in self._plans if (result := read_result(self._result_path(plan))) is not None
        ]
        """Of the courses flown so far."""

    @property
    def total(self) -> int:
        """Number of courses."""
        return len(self._plans)

    @property
    def jobs(self) -> int:
        """Flights at a time: as many as there are cores, unless asked otherwise."""
        return self.options.jobs or all_cores()

    def fly(self, started: Callable[[str], None], ended: Callable[[Result], None]) -> None:
        """Fly the courses that have no result yet; both callbacks are called in the caller's thread.

        On an interrupt all flights are ended, and the results so far are kept.
        """
        done = {result.name for result in self.results}

        def kept(plan: FlightPlan, result: Result) -> None:
            self.results.append(result)
            keep_result(self._result_path(plan), plan, result, self.options.keep)
            ended(result)

        fly_all([plan for plan in self._plans if plan.course.name not in done], self.jobs, started, kept)

    def write_results(self) -> tuple[Path, Path]:
        """Write ``results.csv`` and ``results.json``, in the order of the courses."""
        rows = [dataclasses.asdict(result) for result in sorted(self.results, key=lambda result: result.number)]
        table = write_table(self.options.out / "results.csv", COLUMNS, rows)
        return table, write_json(self.options.out / "results.json", rows)

    def _claim(self) -> None:
        """The folder belongs to campaigns of the same settings; the number of courses may differ."""
        options = self.options
        settings: dict[str, Any] = {
            "seed": options.seed,
            "kinds": list(options.kinds),
            "controller": options.controller,
            "config": None if options.config is None else _digest(options.config),
            "obstacle_speed": options.fastest,
        }
        path = make_folder(options.out) / SETTINGS
        if path.exists():
            found = _json(path)
            for name, value in settings.items():
                if found.get(name) != value:
                    reason = f"was begun with {name} {found.get(name)}, not {value}: name another with --out"
                    raise UnusableInput(f"{options.out}: {reason}")
        elif any(options.out.iterdir()):
            raise UnusableInput(f"{options.out}: is neither empty nor the folder of a campaign")
        else:
            write_json(path, settings)

    def _plan(self, number: int, flags: tuple[str, ...], config: SystemConfig | None) -> FlightPlan:
        options = self.options
        kind = options.kinds[(number - 1) % len(options.kinds)]
        path = options.out / "missions" / f"{number:04d}-{kind}.toml"
        course = generate(options.seed, number, kind, config, options.fastest)
        if not path.exists() or path.read_text(encoding="utf-8") != course.text:
            # The generator has changed since: what was flown was another course.
            (options.out / "results" / f"{course.name}.json").unlink(missing_ok=True)
            path.write_text(course.text, encoding="utf-8")
        return FlightPlan(course, path, options.out / "flights" / course.name, flags)

    def _result_path(self, plan: FlightPlan) -> Path:
        return self.options.out / "results" / f"{plan.course.name}.json"


def all_cores() -> int:
    """How many flights go side by side where it is not said."""
    return len(os.sched_getaffinity(0))


def fly_all(
    plans: Sequence[FlightPlan],
    jobs: int,
    started: Callable[[str], None],
    ended: Callable[[FlightPlan, Result], None],
) -> None:
    """Fly ``plans``, ``jobs`` at a time; both callbacks are called in the caller's thread. An interrupt ends all."""
    waiting = list(plans)
    stop = threading.Event()
    flying: dict[Future[Result | None], FlightPlan] = {}
    with ThreadPoolExecutor(jobs) as pool:
        try:
            while waiting or flying:
                while waiting and len(flying) < jobs:
                    plan = waiting.pop(0)
                    flying[pool.submit(fly_course, plan, stop)] = plan
                    started(plan.course.name)
                finished, _ = wait(flying, timeout=1.0, return_when=FIRST_COMPLETED)
                for future in finished:
                    plan = flying.pop(future)
                    if (result := future.result()) is not None:
                        ended(plan, result)
        finally:
            stop.set()


def read_result(path: Path) -> Result | None:
    """A result that was kept; None where there is none, or one of another version."""
    if not path.exists():
        return None
    content = _json(path)
    if not REQUIRED <= content.keys() <= set(COLUMNS):
        return None
    return Result(**content)


def keep_result(path: Path, plan: FlightPlan, result: Result, keep: str) -> None:
    """Write a result to ``path``; remove its run folder unless ``keep``, one of :data:`KEPT`, says otherwise."""
    write_json(path, result)
    if keep == "none" or (keep == "failures" and result.passed):
        shutil.rmtree(plan.run_dir, ignore_errors=True)


def write_table(path: Path, columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> Path:
    """Write a CSV file. Raises :class:`UnusableInput` where it cannot."""
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns)
            writer.writeheader()
            writer.writerows(rows)
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None
    return path


def _json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UnusableInput(f"{path}: cannot be read: {error}") from None
    return content if isinstance(content, dict) else {}


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
