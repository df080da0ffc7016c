"""Many random courses side by side: generated, flown on all cores, each result kept as soon as it is there."""

from __future__ import annotations

import dataclasses
import hashlib
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gcs.campaign.courses.flights import COLUMNS, REQUIRED, FlightPlan, Result, fly_course
from gcs.campaign.courses.generator import KINDS, generate
from gcs.campaign.process_pool import (
    all_cores,
    claim_folder,
    drops_run_folder,
    fly_side_by_side,
    read_object,
    remove_folder,
    sole_flyer,
    write_table,
)
from gcs.config import SystemConfig, read_system
from gcs.record.run_folder import make_folder, write_json

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

        with sole_flyer(self.options.out):
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
        claim_folder(options.out / SETTINGS, settings, write_json)

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


def fly_all(
    plans: Sequence[FlightPlan],
    jobs: int,
    started: Callable[[str], None],
    ended: Callable[[FlightPlan, Result], None],
) -> None:
    """Fly ``plans``, ``jobs`` at a time; both callbacks are called in the caller's thread. An interrupt ends all."""
    fly_side_by_side(plans, jobs, fly_course, lambda plan: started(plan.course.name), ended)


def read_result(path: Path) -> Result | None:
    """A result that was kept; None where there is none, or one of another version."""
    if not path.exists():
        return None
    content = read_object(path)
    if not REQUIRED <= content.keys() <= set(COLUMNS):
        return None
    return Result(**content)


def keep_result(path: Path, plan: FlightPlan, result: Result, keep: str) -> None:
    """Write a result to ``path``; remove its run folder unless ``keep``, one of :data:`KEPT`, says otherwise."""
    write_json(path, result)
    if drops_run_folder(keep, result.passed):
        remove_folder(plan.run_dir)


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:16]
