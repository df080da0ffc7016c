"""Plans of flights with faults (``gcs faults``): every case in every mission with every seed."""

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from rich.console import RenderableType

from gcs.campaign.engine import PlanGenerator
from gcs.campaign.faults.campaign_file import CampaignFile
from gcs.campaign.faults.cases import CLEAN
from gcs.campaign.faults.detection_table import Detections, detections
from gcs.campaign.faults.judgement import COLUMNS, SAFE, WITHIN_LIMITS, judge, meets
from gcs.campaign.flight import FlightPlan
from gcs.campaign.folder import digest, plain
from gcs.campaign.result import Result
from gcs.campaign.tables import check_parquet, flight_columns, write_parquet
from gcs.errors import UnusableInput

MAX_FLIGHTS = 1_000_000


class FaultFlights(PlanGenerator):
    """Every case of a campaign file in every mission with every seed of its, in this order.

    A name holds a digest of everything that the flight is flown by, except the program: another flight has another.
    """

    columns = COLUMNS
    shown = (
        ("clearance", "clearance_min_m", "m"),
        ("tilt", "tilt_max_deg", "deg"),
        ("separation", "uav_separation_min_m", "m"),
        ("error", "position_rmse_m", "m"),
    )

    def __init__(self, file: CampaignFile, *, parquet: bool = False) -> None:
        """``parquet``: results in this form, too. Raises :class:`UnusableInput` for too many flights, or without it."""
        if parquet:
            check_parquet()
        self.file, self._parquet = file, parquet
        count = len(file.missions) * sum(len(file.seeds_of(case)) for case in file.cases)
        if count > MAX_FLIGHTS:
            raise UnusableInput(f"{count} flights are more than {MAX_FLIGHTS}: list fewer faults, missions or seeds")
        if file.require != WITHIN_LIMITS:
            armed = "" if file.require == SAFE else ", every vehicle disarmed"
            self.passed_means = f"set down safely, with their limits held{armed}"

    @property
    def settings(self) -> dict[str, Any]:
        """The name: a campaign may grow."""
        return {"faults": self.file.name}

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield all flights, by case, then mission, then seed."""
        file, folder = self.file, out / "missions"
        flights = [
            (case, mission, seed) for case in file.cases for mission in file.missions for seed in file.seeds_of(case)
        ]
        for number, (case, mission, seed) in enumerate(flights, start=1):
            base = file.missions[mission]
            title = " ".join(part for part in (mission, case.name, case.severity) if part)
            text = base.text(title, seed, case.faults_for(seed), file.limits)
            name = plain(" ".join([case.name, case.severity, Path(mission).stem, f"seed{seed}"]))
            name += f"-{digest(text, file.controller)}"
            path = folder / f"{name}.toml"
            yield FlightPlan(
                number,
                name,
                path,
                partial(judge, case),
                file.controller,
                labels={"fault": case.name, "kind": case.kind, "level": case.level, "severity": case.severity,
                        "mission": mission, "seed": seed, "true_source": ", ".join(map(str, case.sources))},
                files={path: text, **{folder / file_name: content for file_name, content in base.files.items()}},
            )  # fmt: skip

    def passes(self, result: Result) -> bool:
        """Return whether a flight meets the requirement of the campaign file."""
        return meets(self.file.require, result)

    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write ``results.csv`` (and ``results.parquet``), ``timing.csv``, ``rates.csv`` and the matrix."""
        from gcs.campaign.faults.pairs_report import pairs_report  # matplotlib takes long to import
        from gcs.campaign.faults.report import report

        if self.file.is_of_pairs:
            parts, files = pairs_report(self.file.name, results, self.file.cases, out)
        else:
            parts, files = report(self.file.name, results, out, self.detections(results))
        if self._parquet:
            files.append(write_parquet(out / "results.parquet", flight_columns(COLUMNS), results))
        return parts, files

    def detections(self, results: Sequence[Result]) -> list[Detections]:
        """Return the rows of the table of detection."""
        return detections(self.file.rows, results)

    def problems(self, results: Sequence[Result]) -> list[str]:
        """Return the limits of the table of detection that are not held, and what it lacks."""
        problems = [problem for row in self.detections(results) for problem in row.problems]
        lacking = [result for result in results if result.fault != CLEAN and not result.isolation]
        if self.file.rows and lacking:
            problems.append(f"{len(lacking)} flights without a record of their faults: {lacking[0].name}, ...")
        return problems
