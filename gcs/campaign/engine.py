"""The campaign engine: flies the plans of a generator, once each, whatever happens in between."""

import dataclasses
import shlex
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from multiprocessing import get_context
from pathlib import Path
from typing import Any, ClassVar

from rich.console import RenderableType

from gcs.campaign.flight_worker import FlightWorker
from gcs.campaign.folder import adopt_folder, check_adoptable, folder_lock, remove_folder, write_text
from gcs.campaign.process_pool import FlownProcess, all_cores, fly_process, run_parallel
from gcs.campaign.product import verdict_key
from gcs.campaign.result import Result, read_result, summary_columns
from gcs.errors import UnwritableRecord
from gcs.record.incomplete import INCOMPLETE
from gcs.record.run_folder import UnwritableFile, check_writable, make_folder, write_json

KEEP = ("failures", "all", "none")
"""The flights whose run folders are kept."""


@dataclass(frozen=True)
class FlightPlan:
    """One flight: the mission file, the options of ``gcs fly``, and how the flight is judged.

    ``labels`` are columns of its result that are known before the flight, ``files`` are written before it; ``judge``
    returns the columns that follow from its process and its run folder, ``failures`` and ``outcome`` among them.
    ``fly`` flies and judges it in another process; None: ``gcs fly`` does.
    """

    number: int
    name: str
    mission: Path
    options: tuple[str, ...]
    judge: Callable[[FlownProcess, Path], Mapping[str, Any]]
    labels: Mapping[str, Any] = field(default_factory=dict)
    files: Mapping[Path, str] = field(default_factory=dict)
    fly: Callable[["FlightPlan"], Result] | None = None

    @property
    def key(self) -> str:
        """Text that is another where code, mission, seed or options are, by which its result is kept."""
        named = dict(zip(self.options[::2], self.options[1::2], strict=True))
        config = named.pop("--config", None)
        return verdict_key(self.mission, None if config is None else Path(config), *named.values())

    @property
    def replay(self) -> str:
        """The command that repeats the flight."""
        return replay_command(self.mission, self.options)


class PlanGenerator(ABC):
    """The flights of a campaign, and the columns and conditions of its report."""

    what: str = "flights"
    passed_means: str = "within their limits"
    columns: ClassVar[tuple[str, ...]]
    """Columns of a stored result."""
    shown: ClassVar[tuple[tuple[str, str, str], ...]]
    """Columns printed of each flight: title, column and unit."""

    @property
    def settings(self) -> Mapping[str, Any] | None:
        """Settings that another campaign in the same folder must share; None: any."""
        return None

    @abstractmethod
    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield the flights; their files are below ``out``."""

    def passes(self, result: Result) -> bool:
        """Return whether a flight passed."""
        return not result.failures

    def problems(self, results: Sequence[Result]) -> list[str]:
        """Return what all flights together fall short of, a line each."""
        return []

    @abstractmethod
    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write tables and pictures; return what is to be printed, and the files."""


class Campaign:
    """The flights of a campaign in its folder.

    ``missions/`` holds the mission files that are not somebody else's, ``flights/NAME/`` the run folders,
    ``results/NAME.json`` the results. A campaign that is started again flies what has no result yet of the same code,
    mission and seed.
    """

    def __init__(self, generator: PlanGenerator, out: Path, jobs: int | None = None, keep: str = "failures") -> None:
        """Write the missions. Raises :class:`gcs.errors.UnusableInput` for a folder of something else."""
        self.generator, self.out = generator, out
        self._jobs, self._keep = jobs or all_cores(), keep
        settings = generator.settings
        if settings is not None:
            check_adoptable(out, settings)
        check_writable(out)
        self.plans = [*generator.plans(out)]  # refused before anything is written, if at all
        if settings is not None:
            adopt_folder(out, settings)
        for name in ("missions", "flights", "results"):
            make_folder(out / name)
        self._pool = ProcessPoolExecutor(self._jobs, get_context("spawn"))  # starts none yet
        self._results: dict[str, Result] = {}
        for plan in self.plans:
            for path, text in plan.files.items():
                write_text(path, text)
            if (result := read_result(self.result_path(plan), plan.key, generator.columns)) is not None:
                self._results[plan.name] = self._judged(plan, result)

    @property
    def results(self) -> list[Result]:
        """The results so far, in the order of the plans."""
        return [self._results[plan.name] for plan in self.plans if plan.name in self._results]

    def fly(
        self,
        started: Callable[[FlightPlan], None],
        ended: Callable[[Result], None],
        plans: Sequence[FlightPlan] | None = None,
    ) -> None:
        """Fly what has no result yet, of ``plans`` (None: of all); both callbacks are called in the caller's thread.

        On an interrupt all flights are ended, and the results so far are kept. Raises
        :class:`gcs.errors.UnusableInput` when another process flies in the folder, and
        :class:`gcs.errors.UnwritableRecord` when a result cannot be written.
        """

        def keep(plan: FlightPlan, result: Result) -> None:
            discard = self._keep == "none" or (self._keep == "failures" and result.passed)
            if discard:
                result = dataclasses.replace(result, run_dir="")
            try:
                write_json(self.result_path(plan), {"key": plan.key, **result.row(self.generator.columns)})
            except UnwritableFile as error:
                raise UnwritableRecord(f"{error}: the campaign ends here; start it again to resume") from None
            self._results[plan.name] = result
            if discard:
                remove_folder(self.run_dir(plan))
            ended(result)

        with folder_lock(self.out):
            if "run_dir" in self.generator.columns:
                for result in self.results:
                    if not result.run_dir:  # the process may have been killed just before it removed the folder
                        remove_folder(self.out / "flights" / result.name)
            chosen = self.plans if plans is None else plans
            waiting = [plan for plan in chosen if plan.name not in self._results]
            run_parallel(waiting, self._jobs, self.fly_one, started, keep)

    def fly_one(self, plan: FlightPlan, worker: FlightWorker) -> Result | None:
        """Fly and judge; None if ``worker.stop`` was set before the flight ended."""
        if plan.fly is not None:
            return self._judged(plan, self._pool.submit(plan.fly, plan).result())
        run_dir = self.run_dir(plan)
        flown = fly_process(plan.mission, plan.options, run_dir, worker)
        return None if flown is None else self.result_of(plan, flown)

    def result_of(self, plan: FlightPlan, flown: FlownProcess) -> Result:
        """Judge a flight."""
        run_dir = self.run_dir(plan)
        return self._judged(plan, Result(**{**summary_columns(flown, run_dir), **plan.judge(flown, run_dir)}))

    def run_dir(self, plan: FlightPlan) -> Path:
        """Return the run folder of a flight."""
        return self.out / "flights" / plan.name

    def result_path(self, plan: FlightPlan) -> Path:
        """Return the file of the result of a flight."""
        return self.out / "results" / f"{plan.name}.json"

    def _judged(self, plan: FlightPlan, result: Result) -> Result:
        """Return the result with what this campaign says of the flight: another one may have flown it."""
        labels: dict[str, Any] = {"number": plan.number, "name": plan.name, "replay": plan.replay, **plan.labels}
        result = dataclasses.replace(result, **labels)
        judged = result.exit_code != INCOMPLETE
        return dataclasses.replace(result, passed=judged and self.generator.passes(result))


def replay_command(mission: Path, options: Sequence[str]) -> str:
    """Return the command that repeats a flight."""
    return shlex.join(["gcs", "fly", str(mission), *options])
