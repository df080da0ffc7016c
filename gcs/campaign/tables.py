"""Tables of results: as files, for the terminal, and in pages."""

import csv
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from rich import box
from rich.table import Table
from rich.text import Text

from gcs.campaign.result import COLUMN_TYPES, TIMING, Result
from gcs.errors import UnusableInput
from gcs.extras import extra

SHOWN_FAILURES = 20
_DTYPES = {"int": "Int64", "float": "Float64", "bool": "boolean", "str": "string"}


def write_csv(path: Path, columns: Sequence[str], rows: Iterable[Mapping[str, Any]]) -> Path:
    """Write a CSV file. Raises :class:`UnusableInput` where it cannot."""
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns, lineterminator="\n")
            writer.writeheader()
            writer.writerows(rows)
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None
    return path


def write_records(path: Path, records: Sequence[Mapping[str, Any]], decimals: str = "") -> Path:
    """Write rows, one at least, as a CSV file, floats in the format ``decimals``.

    Raises :class:`UnusableInput` where it cannot.
    """
    rows = (
        {name: format(value, decimals) if isinstance(value, float) else value for name, value in record.items()}
        for record in records
    )
    return write_csv(path, [*records[0]], rows)


def write_results(out: Path, columns: Sequence[str], results: Sequence[Result]) -> list[Path]:
    """Write ``results.csv``, whose bytes depend on the flights alone, and the other columns as ``timing.csv``."""
    timing = ("number", "name", *(column for column in columns if column in TIMING))
    tables = {"results.csv": flight_columns(columns), "timing.csv": timing}
    return [write_csv(out / file, chosen, [r.row(chosen) for r in results]) for file, chosen in tables.items()]


def flight_columns(columns: Sequence[str]) -> tuple[str, ...]:
    """Return the columns that depend on the flight alone."""
    return tuple(column for column in columns if column not in TIMING)


def check_parquet() -> None:
    """Raise :class:`UnusableInput` where the packages that write Parquet are not installed."""
    with extra("parquet", "--parquet"):
        import pandas  # noqa: F401
        import pyarrow.parquet  # noqa: F401


def write_parquet(path: Path, columns: Sequence[str], results: Sequence[Result]) -> Path:
    """Write a Parquet file, unknown values as missing. Raises :class:`UnusableInput` where it cannot."""
    import pandas  # takes long to import, and no flight needs it
    import pyarrow
    import pyarrow.parquet

    dtypes = {name: _DTYPES[COLUMN_TYPES[name].removesuffix(" | None")] for name in columns}
    frame = pandas.DataFrame([result.row(columns) for result in results], columns=list(dtypes)).astype(dtypes)
    try:
        pyarrow.parquet.write_table(pyarrow.Table.from_pandas(frame, preserve_index=False), path)
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be written: {error.strerror or error}") from None
    return path


def text_table(rows: Sequence[Mapping[str, str]], left: Sequence[str]) -> Table:
    """Return a table of ``rows``, cells by title; columns of ``left`` may wrap, figures do not.

    Columns without any value are left out.
    """
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False)
    titles = [title for title in (rows[0] if rows else ()) if {row[title] for row in rows} - {"", "-"}]
    for title in titles:
        least = max(len(part) for part in (*title.split(), *([] if title in left else (row[title] for row in rows))))
        table.add_column(title, justify="left" if title in left else "right", min_width=least)
    for row in rows:
        table.add_row(*(Text(row[title]) for title in titles))
    return table


def extreme(
    results: Sequence[Result], column: str, of: Callable[[list[float]], float], digits: int, unit: str = ""
) -> str:
    """Return the least (``of`` is min) or largest (max) known value of a column, as text."""
    values = [value for result in results if (value := result.figure(column)) is not None]
    return f"{of(values):.{digits}f} {unit}".strip() if values else "-"


def headline(results: Sequence[Result], what: str, passed_means: str) -> Text:
    """Return how many of the results passed."""
    passed = sum(result.passed for result in results)
    colour = "bold green" if passed == len(results) else "bold red"
    return Text(f"{passed} of {len(results)} {what} {passed_means}", style=colour)


def failed_flights(results: Sequence[Result]) -> list[Text]:
    """Return each flight that did not pass with the reasons and the command that repeats it."""
    failed = [result for result in results if not result.passed]
    lines = []
    for result in failed[:SHOWN_FAILURES]:
        why = "; ".join(part for part in (result.failures, result.reason) if part)
        text = f"{result.name}: {result.outcome}{f' ({why})' if why else ''}"
        lines.append(Text.assemble((text, "red"), f"\n  {result.replay}"))
    if len(failed) > SHOWN_FAILURES:
        lines.append(Text(f"... and {len(failed) - SHOWN_FAILURES} more that did not pass: see the table"))
    return lines
