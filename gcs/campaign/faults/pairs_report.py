"""The report of a campaign of pairs of faults: a row for each value of each factor, and the matrix by phase."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from rich.console import RenderableType

from gcs.campaign.faults.cases import Case
from gcs.campaign.faults.judgement import COLUMNS
from gcs.campaign.faults.report import draw_matrix
from gcs.campaign.result import Result
from gcs.campaign.tables import extreme, text_table, write_records, write_results

_TITLES = {"first": "first fault", "second": "second fault", "phase": "phase", "delay": "delay", "wind": "wind"}
_UNITS = {"delay": " s", "wind": " m/s"}
_FIGURES = ("outcome", "passed", "failures", "reason", "lean_max_deg", "uav_separation_min_m", "contacts",
            "touchdown_mps", "armed_at_end", "notes")  # fmt: skip


def pairs_report(
    name: str, results: Sequence[Result], cases: Sequence[Case], out: Path
) -> tuple[list[RenderableType], list[Path]]:
    """Write the tables and the matrix of first fault and phase; return the table by factor, and the files."""
    factors = {(case.name, case.severity, case.seed): case.factors for case in cases}
    flown = [(result, factors.get((result.fault, result.severity, result.seed), {})) for result in results]
    paired = [(result, found) for result, found in flown if found]
    files = write_results(out, COLUMNS, results)
    if not paired:
        return [], files
    files.append(write_records(out / "pairs.csv", [_record(*one) for one in paired]))
    phases = list(dict.fromkeys(found["phase"] for case in cases if (found := case.factors)))
    by_phase = [
        replace(result, fault=found["first"], level=phases.index(found["phase"]) + 1, severity=found["phase"])
        for result, found in paired
    ]
    files.append(draw_matrix(name, sorted(by_phase, key=lambda result: result.fault), out))
    return [text_table([*_rows(paired)], left=("factor", "value"))], files


def _record(result: Result, factors: Mapping[str, Any]) -> dict[str, Any]:
    figures = {column: getattr(result, column) for column in _FIGURES}
    return {"number": result.number, **factors, "seed": result.seed, **figures, "name": result.name}


def _rows(paired: Sequence[tuple[Result, Mapping[str, Any]]]) -> list[dict[str, str]]:
    rows = []
    for factor, title in _TITLES.items():
        values = sorted({found[factor] for _, found in paired}) if factor in _UNITS else dict.fromkeys(
            found[factor] for _, found in paired
        )  # fmt: skip
        for value in values:
            chosen = [result for result, found in paired if found[factor] == value]
            shown = f"{value:g}{_UNITS[factor]}" if factor in _UNITS else value or "none"
            rows.append(
                {
                    "factor": title, "value": shown, "flights": str(len(chosen)),
                    "passed": str(sum(result.passed for result in chosen)),
                    "completed": str(sum(result.outcome == "completed" for result in chosen)),
                    "largest roll, pitch": extreme(chosen, "lean_max_deg", max, 1, "deg"),
                    "least separation": extreme(chosen, "uav_separation_min_m", min, 2, "m"),
                    "touchdown": extreme(chosen, "touchdown_mps", max, 2, "m/s"),
                }
            )  # fmt: skip
            title = ""
    return rows
