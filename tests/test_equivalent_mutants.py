"""Mutants that no test can notice: each entry names a line that is still there."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_equivalent_mutant_is_of_a_line_of_its_file():
    entries = tomllib.loads((ROOT / "tests" / "mutation" / "equivalent.toml").read_text())["equivalent"]
    assert entries
    for entry in entries:
        lines = [line.strip() for line in (ROOT / entry["path"]).read_text().splitlines()]
        assert entry["line"] in lines, f"{entry['path']}: {entry['line']}"
        assert entry["reason"]
