"""Compare the figures of README.md and docs/**.md with what docs/claims.toml says of them.

  python tests/claims/claims.py                   settings, and what takes seconds; minutes: by the last record
  python tests/claims/claims.py --all             run the commands that take minutes and were not run at this commit
  python tests/claims/claims.py --all NAME ...    run these, whatever the record has
  python tests/claims/claims.py --list            the commands, their cost, and the commit of their record
  python tests/claims/claims.py --write           put the values into the documents, as their figures are printed

docs/measured.json records the results of commands that take minutes, after each of them: what was interrupted goes on
when started again. Exit status: 0 every figure is right, 1 not, 2 the file of claims cannot be used.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections import Counter
from collections.abc import Sequence
from pathlib import Path

HERE = Path(__file__).parent
sys.path[:0] = [str(HERE), str(HERE.parent / "pages"), str(HERE.parents[1])]

from claims_file import CLASSES, ClaimsError, ClaimsFile, last_digit, read_claims  # noqa: E402
from documents import Found, found_figures, uncovered  # noqa: E402
from page_tables import commit_of  # noqa: E402
from rich.console import Console  # noqa: E402
from rich.table import Table  # noqa: E402
from rich.text import Text  # noqa: E402
from sources import ROOT, Record, Values, cpu_seconds, run  # noqa: E402

FILE, RECORD = ROOT / "docs" / "claims.toml", ROOT / "docs" / "measured.json"


def documents() -> dict[str, str]:
    """Return the texts whose figures have claims, by name."""
    paths = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
    return {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in paths}


def problems(claims: ClaimsFile, values: Values, texts: dict[str, str]) -> list[str]:
    """Return a line for each figure that is wrong or in no claim, and for each claim whose text is not there."""
    lines = []
    for claim in claims.claims:
        found = found_figures(claim, texts.get(claim.document, ""))
        if not found:
            count = len(claim.pattern.findall(texts.get(claim.document, "")))
            lines.append(f"{claim.document}: the text of a claim is found {count} times: {claim.text}")
        lines += [problem for part in found if (problem := _compared(part, values, texts[claim.document]))]
    for part in claims.definitions:
        if not part.pattern.search(texts.get(part.document, "")):
            lines.append(f"{part.document}: the text of a definition is not found: {part.text}")
    return lines + [line for name, text in texts.items() for line in uncovered(name, text, claims)]


def written(claims: ClaimsFile, values: Values, texts: dict[str, str]) -> dict[str, str]:
    """Return the texts with the values in place of figures that are wrong."""
    changed = dict(texts)
    for name, text in texts.items():
        found = [part for claim in claims.claims if claim.document == name for part in found_figures(claim, text)]
        for part in sorted(found, key=lambda part: -part.begin):
            if not values.has(part.claim, part.figure) or not _compared(part, values, text):
                continue
            value = printed(values.of(part.claim, part.figure), part)
            changed[name] = changed[name][: part.begin] + value + changed[name][part.end :]
    return changed


def printed(value: float, found: Found) -> str:
    """Return a value as the document prints its figure; a bound is rounded to its own side."""
    digit = last_digit(found.text)
    if found.figure.bound:
        # A value that is the bound to the last digit may lie beside it by a rounding error.
        steps = value / digit
        value = digit * (math.floor(steps + 1e-6) if found.figure.bound == ">=" else math.ceil(steps - 1e-6))
    mantissa, exponent, _ = found.text.partition("e")
    places = len(mantissa.partition(".")[2])
    if exponent:
        head, _, power = f"{value:.{places}e}".partition("e")
        return f"{head}e{int(power)}"
    return f"{value:,.{places}f}" if "," in mantissa else f"{value:.{places}f}"


def _compared(part: Found, values: Values, text: str) -> str:
    """Return what is wrong with a figure; empty: nothing."""
    try:
        value = values.of(part.claim, part.figure)
    except ClaimsError as error:
        return f"{part.claim.document}: {part.claim.source}: {error}"
    least, most = part.figure.allowed(part.text)
    if least <= value <= most:
        return ""
    line = text.count("\n", 0, part.begin) + 1
    bound = {">=": "at least ", "<=": "at most "}.get(part.figure.bound, "")
    return (
        f"{part.claim.document}:{line}: says {bound}{part.text}, is {value:.6g} "
        f"({part.claim.source}: {part.figure.expression})"
    )


def measure(claims: ClaimsFile, record: Record, names: Sequence[str], console: Console) -> None:
    """Run the commands of ``names``, or those whose record is of another commit; record each at once."""
    commit = commit_of(ROOT / "docs")
    for name, source in claims.sources.items():
        wanted = _expressions(claims, name)
        old = record.lacks(source, wanted) or record.measured[name].commit != commit
        if not source.command or (name not in names if names else not old):
            continue
        console.print(f"{name}: {source.command}", markup=False)
        before = cpu_seconds()
        record.measured[name] = run(source, commit, wanted)
        record.write()
        console.print(f"  {(cpu_seconds() - before) / 60.0:.1f} minutes of CPU")


def main(arguments: Sequence[str]) -> int:
    """Do what the arguments say, and return the exit status."""
    parser = argparse.ArgumentParser(description="Compare the figures of the documents with docs/claims.toml.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="sources whose commands are run, with --all")
    parser.add_argument("--all", action="store_true", help="run the commands that take minutes")
    parser.add_argument("--list", action="store_true", help="print the commands")
    parser.add_argument("--write", action="store_true", help="correct the figures of the documents")
    options = parser.parse_args(arguments)
    console = Console(highlight=False, soft_wrap=True, emoji=False)
    try:
        claims, record = read_claims(FILE), Record(RECORD)
        if unknown := set(options.names) - claims.sources.keys():
            raise ClaimsError(f"no such source: {', '.join(sorted(unknown))}")
        if options.list:
            console.print(_listed(claims, record))
            return 0
        if options.all:
            measure(claims, record, options.names, console)
        values = Values(claims, record)
        if options.write:
            for name, text in written(claims, values, documents()).items():
                (ROOT / name).write_text(text, encoding="utf-8")
        found = problems(claims, values, documents())
    except KeyboardInterrupt:
        return 130
    except ClaimsError as error:
        console.print(str(error), style="red", markup=False)
        return 2
    for line in dict.fromkeys(found):
        console.print(line, markup=False)
    console.print(_counts(claims, record, len(found)), markup=False)
    return 1 if found else 0


def _expressions(claims: ClaimsFile, source: str) -> list[str]:
    return [figure.expression for claim in claims.claims if claim.source == source for figure in claim.figures]


def _listed(claims: ClaimsFile, record: Record) -> Table:
    table = Table("source", "CPU (min)", "measured at", "command")
    for name, source in claims.sources.items():
        if source.command:
            commit = record.measured[name].commit if name in record.measured else ""
            table.add_row(name, f"{source.minutes:g}", commit, Text(source.command))
    return table


def _counts(claims: ClaimsFile, record: Record, wrong: int) -> str:
    counts = Counter[str]()
    for claim in claims.claims:
        counts[claims.kind(claim.source)] += len(claim.figures)
    commit = commit_of(ROOT / "docs")
    old = sum(entry.commit != commit for name, entry in record.measured.items() if name in claims.sources)
    opened = sum(part.reason.startswith("open") for part in claims.definitions)
    classes = ", ".join(f"{counts[name]} {name}" for name in CLASSES)
    return (
        f"{sum(counts.values())} figures ({classes}), {len(claims.definitions)} definitions ({opened} open), "
        f"{wrong} problems; "
        f"{old} of {len(record.measured)} records of an earlier commit (make claims-all); {cpu_seconds():.1f} s of CPU"
    )


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
