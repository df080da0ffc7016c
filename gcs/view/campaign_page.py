"""The page of a campaign's folder: matrix or list of its flights, distributions, the worst flights first."""

import csv
from pathlib import Path
from typing import Any

from gcs.errors import UnusableInput
from gcs.record.reader import read_json
from gcs.record.run_data import read_run
from gcs.view.page import REPORT, page, script, write_page, write_report

RESULTS, TIMING = "results.csv", "timing.csv"


def is_campaign(folder: Path) -> bool:
    """Return whether a folder is that of a campaign, and not of a run."""
    return (folder / RESULTS).is_file()


def write_campaign(folder: Path) -> Path:
    """Write ``report.html`` of a campaign into its folder, and return its path.

    It links to the pages of the flights whose run folders were kept, which are written where they are missing.
    Raises :class:`UnusableInput` for tables that cannot be read, and where the page cannot be written.
    """
    timing = {row.get("name"): row for row in _rows(folder / TIMING)}
    flights = []
    for row in _rows(folder / RESULTS):
        more = timing.get(row.get("name"), {})
        report = _page_of(folder / "flights" / row.get("name", ""))
        link = None if report is None else report.relative_to(folder).as_posix()
        flights.append({**row, "replay": more.get("replay", ""), "page": link})
    if not flights:
        raise UnusableInput(f"{folder / RESULTS}: has no flight")
    name = folder.resolve().name
    content: dict[str, Any] = {"name": name, "settings": read_json(folder / "campaign.json"), "flights": flights}
    passed = sum(flight.get("passed") == "True" for flight in flights)
    title = f"{name}: {passed} of {len(flights)} flights passed"
    return write_page(folder / REPORT, page(title, script("campaign", content)))


def _page_of(run_dir: Path) -> Path | None:
    """Return the page of a flight; None where its records were not kept, or are none."""
    if (run_dir / REPORT).is_file():
        return run_dir / REPORT
    try:
        return write_report(read_run(run_dir))
    except UnusableInput:
        return None


def _rows(path: Path) -> list[dict[str, str]]:
    try:
        with path.open(newline="", encoding="utf-8") as file:
            return [*csv.DictReader(file)]
    except FileNotFoundError:
        return []
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise UnusableInput(f"{path}: cannot be read: {error}") from None
