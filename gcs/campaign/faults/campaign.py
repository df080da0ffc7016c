"""The flights of a campaign in its folder: each flown once, whatever happens in between."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from gcs.campaign.faults.base_mission import write_text
from gcs.campaign.faults.campaign_file import CampaignFile
from gcs.campaign.faults.result import COLUMNS, FaultResult, evaluate, replay_command
from gcs.campaign.faults.sweep import FaultFlight, flights_of
from gcs.campaign.process_pool import (
    all_cores,
    claim_folder,
    drops_run_folder,
    fly_process,
    fly_side_by_side,
    read_object,
    remove_folder,
    sole_flyer,
)
from gcs.errors import UnusableInput
from gcs.record.run_folder import make_folder, write_json

SETTINGS = "campaign.json"
MOST_FLIGHTS = 1_000_000


@dataclass(frozen=True)
class FaultCampaignOptions:
    """What the command line of ``gcs faults`` asks for."""

    out: Path
    jobs: int | None = None
    keep: str = "failures"


class FaultCampaign:
    """The flights of a campaign in its folder.

    ``missions/NAME.toml`` are the missions, with the files that they need, ``flights/NAME/`` the run folders,
    ``results/NAME.json`` what came of each. Started again, also with more faults, seeds or missions in its file, it
    flies what has no result yet: the names say what is flown.
    """

    def __init__(self, file: CampaignFile, options: FaultCampaignOptions) -> None:
        """Write the missions. Raises :class:`UnusableInput` for a folder of something else, and where it cannot."""
        self.file, self.options = file, options
        count = len(file.cases) * len(file.missions) * len(file.seeds)
        if count > MOST_FLIGHTS:
            raise UnusableInput(f"{count} flights are more than {MOST_FLIGHTS}")
        out = options.out
        claim_folder(out / SETTINGS, {"faults": file.name}, write_json)
        for name in ("missions", "flights", "results"):
            make_folder(out / name)
        for base in file.missions.values():
            base.write_files(out / "missions")
        self.flights: list[FaultFlight] = []
        self._results: dict[str, FaultResult] = {}
        for flight in flights_of(file):
            write_text(self._mission_path(flight), flight.text)
            self.flights.append(flight)
            if (result := self._read(flight)) is not None:
                self._results[flight.name] = result

    @property
    def total(self) -> int:
        """Number of flights."""
        return len(self.flights)

    @property
    def results(self) -> list[FaultResult]:
        """Of the flights flown so far, in the order of the flights."""
        return [self._results[flight.name] for flight in self.flights if flight.name in self._results]

    def fly(self, started: Callable[[str], None], ended: Callable[[FaultResult], None]) -> None:
        """Fly those that have no result yet; both callbacks are called in the caller's thread.

        On an interrupt all flights are ended, and the results so far are kept. Raises :class:`UnusableInput` when
        another process flies in the folder.
        """

        def kept(flight: FaultFlight, result: FaultResult) -> None:
            drop = drops_run_folder(self.options.keep, result.passed)
            if drop:
                result = dataclasses.replace(result, run_dir="")
            write_json(self._result_path(flight), result)
            self._results[flight.name] = result
            if drop:
                remove_folder(self._run_dir(flight))
            ended(result)

        with sole_flyer(self.options.out):
            waiting = [flight for flight in self.flights if flight.name not in self._results]
            for flight in self.flights:
                if flight.name in self._results and not self._results[flight.name].run_dir:
                    remove_folder(self._run_dir(flight))  # of a campaign that was killed just before it did
            fly_side_by_side(
                waiting, self.options.jobs or all_cores(), self._fly, lambda flight: started(flight.name), kept
            )

    def _fly(self, flight: FaultFlight, stop: threading.Event) -> FaultResult | None:
        mission, run_dir = self._mission_path(flight), self._run_dir(flight)
        options = ("--controller", self.file.controller)
        ended = fly_process(mission, options, run_dir, stop)
        if ended is None:
            return None
        return evaluate(flight, ended, run_dir, replay_command(mission, options)).held_to(self.file.require)

    def _read(self, flight: FaultFlight) -> FaultResult | None:
        """The result that was kept; None where there is none, or one of another version."""
        path = self._result_path(flight)
        if not path.exists():
            return None
        content = read_object(path)
        if set(content) != set(COLUMNS):
            return None
        # In a campaign that has grown it stands elsewhere.
        result = dataclasses.replace(FaultResult(**content), number=flight.number, level=flight.case.level)
        return result.held_to(self.file.require)

    def _mission_path(self, flight: FaultFlight) -> Path:
        return self.options.out / "missions" / f"{flight.name}.toml"

    def _run_dir(self, flight: FaultFlight) -> Path:
        return self.options.out / "flights" / flight.name

    def _result_path(self, flight: FaultFlight) -> Path:
        return self.options.out / "results" / f"{flight.name}.json"
