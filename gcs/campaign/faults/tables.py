"""The tables of a campaign as files: a row a flight, and rates with their confidence intervals."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import pandas
import pyarrow
import pyarrow.parquet
from scipy.stats import binomtest

from gcs.campaign.faults.result import FaultResult
from gcs.errors import UnusableInput

CONFIDENCE = 0.95
_DTYPES = {
    "int": "Int64", "int | None": "Int64", "float": "Float64", "float | None": "Float64",
    "bool": "boolean", "bool | None": "boolean", "str": "string",
}  # fmt: skip


@dataclass(frozen=True)
class Rates:
    """Of all flights with one fault at one severity: counts, and rates with the ends of their Wilson intervals.

    ``safe``: set down without contact, in whatever way.
    """

    fault: str
    kind: str
    level: int
    severity: str
    flights: int
    within_limits: int
    within_limits_rate: float
    within_limits_low: float
    within_limits_high: float
    safe: int
    safe_rate: float
    safe_low: float
    safe_high: float


def rates_of(results: Sequence[FaultResult]) -> list[Rates]:
    """One of each fault and severity that was flown, in the order of the results."""
    groups: dict[tuple[str, int], list[FaultResult]] = {}
    for result in results:
        groups.setdefault((result.fault, result.level), []).append(result)
    rates = []
    for group in groups.values():
        first, count = group[0], len(group)
        within = sum(result.within_limits for result in group)
        safe = sum(result.safe for result in group)
        rates.append(
            Rates(
                first.fault, first.kind, first.level, first.severity, count,
                within, within / count, *interval(within, count), safe, safe / count, *interval(safe, count),
            )
        )  # fmt: skip
    return rates


def interval(successes: int, trials: int) -> tuple[float, float]:
    """Wilson's confidence interval of a rate, at :data:`CONFIDENCE`."""
    found = binomtest(successes, trials).proportion_ci(confidence_level=CONFIDENCE, method="wilson")
    return float(found.low), float(found.high)


def results_frame(results: Sequence[FaultResult]) -> pandas.DataFrame:
    """A row a flight; what is not known is missing."""
    return _frame(FaultResult, [dataclasses.asdict(result) for result in results])


def write_tables(results: Sequence[FaultResult], folder: Path) -> list[Path]:
    """Write ``results.csv``, ``results.parquet`` and ``rates.csv``. Raises :class:`UnusableInput` where it cannot."""
    frame = results_frame(results)
    rates = _frame(Rates, [dataclasses.asdict(rate) for rate in rates_of(results)])
    paths = [folder / name for name in ("results.csv", "results.parquet", "rates.csv")]
    try:
        frame.to_csv(paths[0], index=False)
        pyarrow.parquet.write_table(pyarrow.Table.from_pandas(frame, preserve_index=False), paths[1])
        rates.to_csv(paths[2], index=False, float_format="%.4f")
    except OSError as error:
        raise UnusableInput(f"{folder}: the tables cannot be written: {error.strerror or error}") from None
    return paths


def _frame(row: type, rows: list[dict[str, object]]) -> pandas.DataFrame:
    dtypes = {field.name: _DTYPES[str(field.type)] for field in dataclasses.fields(row)}
    return pandas.DataFrame(rows, columns=list(dtypes)).astype(dtypes)
