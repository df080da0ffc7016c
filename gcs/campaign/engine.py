"""The campaign engine: flies the plans of a generator, once each, whatever happens in between."""

import dataclasses
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, ClassVar

from rich.console import RenderableType

from gcs.campaign.executors import ATTEMPTS, carry_out
from gcs.campaign.flight import OUTSIDE_LIMITS, FlightPlan, fly_plan
from gcs.campaign.folder import adopt_folder, check_adoptable, folder_lock, remove_folder, write_text
from gcs.campaign.result import Flown, Result, read_result
from gcs.errors import UnwritableRecord
from gcs.record.incomplete import INCOMPLETE
from gcs.record.run_folder import UnwritableFile, check_writable, make_folder, write_json

KEEP = ("failures", "all", "none")
"""The flights whose run folders are kept."""


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

    def __init__(self, generator: PlanGenerator, out: Path, keep: str = "failures") -> None:
        """Write the missions. Raises :class:`gcs.errors.UnusableInput` for a folder of something else."""
        self.generator, self.out, self._keep = generator, out, keep
        settings = generator.settings
        if settings is not None:
            check_adoptable(out, settings)
        check_writable(out)
        self.plans = [*generator.plans(out.absolute())]  # refused before anything is written, if at all
        if settings is not None:
            adopt_folder(out, settings)
        for name in ("missions", "flights", "results"):
            make_folder(out / name)
        self._results: dict[str, Result] = {}
        for plan in self.plans:
            for path, text in plan.files.items():
                write_text(path, text)
            if (result := read_result(self.result_path(plan), plan.key, generator.columns)) is not None:
                self._results[plan.name] = self.judged(plan, result)

    @property
    def results(self) -> list[Result]:
        """The results so far, in the order of the plans."""
        return [self._results[plan.name] for plan in self.plans if plan.name in self._results]

    def fly(
        self,
        executor: Executor,
        ended: Callable[[Result], None],
        plans: Sequence[FlightPlan] | None = None,
    ) -> None:
        """Fly what has no result yet, of ``plans`` (None: of all), by calls of ``executor``.

        ``ended`` is called in the caller's thread.

        On an interrupt the flights under way are abandoned, and the results so far are kept. Raises
        :class:`gcs.errors.UnusableInput` when another process flies in the folder, and
        :class:`gcs.errors.UnwritableRecord` when a result cannot be written.
        """

        def keep(plan: FlightPlan, result: Result | None) -> None:
            result = self._kept(plan, result)
            try:
                write_json(self.result_path(plan), {"key": plan.key, **result.row(self.generator.columns)})
            except UnwritableFile as error:
                raise UnwritableRecord(f"{error}: the campaign ends here; start it again to resume") from None
            self._results[plan.name] = result
            ended(result)

        with folder_lock(self.out):
            chosen = self.plans if plans is None else plans
            waiting = [plan for plan in chosen if plan.name not in self._results]
            carry_out(executor, partial(fly_plan, folder=self.out.absolute() / "flights"), waiting, keep)

    def _kept(self, plan: FlightPlan, result: Result | None) -> Result:
        """Return the result of a flight with its run folder in its place, if that is to be kept."""
        run_dir = self.run_dir(plan)
        remove_folder(run_dir)
        if result is None:
            reason = f"its process was killed {ATTEMPTS} times"
            result = plan.result(Flown(OUTSIDE_LIMITS, {}, reason, 0.0), run_dir)
        result = self.judged(plan, result)
        if not result.run_dir:
            return result
        if self._keep == "none" or (self._keep == "failures" and result.passed):
            remove_folder(Path(result.run_dir))
            return dataclasses.replace(result, run_dir="")
        Path(result.run_dir).replace(run_dir)
        return dataclasses.replace(result, run_dir=str(run_dir))

    def run_dir(self, plan: FlightPlan) -> Path:
        """Return the run folder of a flight."""
        return self.out / "flights" / plan.name

    def result_path(self, plan: FlightPlan) -> Path:
        """Return the file of the result of a flight."""
        return self.out / "results" / f"{plan.name}.json"

    def judged(self, plan: FlightPlan, result: Result) -> Result:
        """Return the result with what this campaign says of the flight: another one may have flown it."""
        labels: dict[str, Any] = {"number": plan.number, "name": plan.name, "replay": plan.replay, **plan.labels}
        result = dataclasses.replace(result, **labels)
        judged = result.exit_code != INCOMPLETE
        return dataclasses.replace(result, passed=judged and self.generator.passes(result))
