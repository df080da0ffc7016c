"""The worked examples of CONTRIBUTING.md, carried out in a copy of the project.

A section ``## Add ...`` lists its files, changes them in ``diff`` blocks, and proves the result in a ``python`` block.
"""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
COPIED = ("gcs", "idc_controller", "vehicle_sim", "missions", "docs", "pyproject.toml")
MOST_FILES = {
    # What a change of that kind may touch beside its tests: more means that one thing has several places.
    "Add an obstacle shape": 3,
    "Add a fault kind": 3,
    "Add a constraint": 2,
    "Add a vehicle message": 2,
    "Add a mission command": 2,
    "Add a failsafe or alarm": 1,
    "Add a QP solver": 1,
}
SECTION = re.compile(r"^## (Add [^\n]+)\n(.*?)(?=^## |\Z)", re.MULTILINE | re.DOTALL)
BLOCK = re.compile(r"^```(\w+)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
FILE = re.compile(r"^--- (\S+)\n\+\+\+ (\S+)\n", re.MULTILINE)

EXAMPLES = dict(match.groups() for match in SECTION.finditer((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")))


def apply(diff, root):
    """Apply a unified diff whose hunks are found by their lines; return the paths of the files it changes."""
    parts = FILE.split(diff)[1:]
    for old, new, hunks in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
        path = root / new
        text = "" if old == "/dev/null" else path.read_text(encoding="utf-8")
        for hunk in re.split(r"^@@.*\n", hunks, flags=re.MULTILINE)[1:]:
            lines = hunk.splitlines()
            before = "".join(line[1:] + "\n" for line in lines if not line.startswith("+"))
            after = "".join(line[1:] + "\n" for line in lines if not line.startswith("-"))
            assert text.count(before) == 1 or not text, f"{new}: the context of a hunk is not found once:\n{before}"
            text = text.replace(before, after) if text else after
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    return parts[1::3]


def copy_of_project(root):
    """Copy what the programs and their documents are made of, with the kernels as they are compiled."""
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, root / name, ignore=shutil.ignore_patterns("*.pyc"))
        else:
            shutil.copy(source, root / name)


def run(root, *arguments):
    """Run the interpreter in a copy of the project; return what it printed if it failed."""
    process = subprocess.run(
        [sys.executable, *arguments], cwd=root, env={"PYTHONPATH": str(root), "PATH": ""},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    return process.stdout + process.stderr if process.returncode else ""


def test_every_kind_of_addition_has_a_worked_example():
    assert list(EXAMPLES) == list(MOST_FILES)


@pytest.mark.slow
@pytest.mark.parametrize("title", EXAMPLES)
def test_worked_example_works_with_the_files_that_it_lists(title, tmp_path):
    body = EXAMPLES[title]
    copy_of_project(tmp_path)
    listed = re.search(r"^Files: (.+?)\.\n", body, re.MULTILINE | re.DOTALL)
    assert listed, f"{title}: no list of files"
    blocks = BLOCK.findall(body)
    changed = sorted({path for kind, text in blocks if kind == "diff" for path in apply(text, tmp_path)})
    assert changed == sorted(re.findall(r"`([^`]+)`", listed.group(1)))
    assert len(changed) <= MOST_FILES[title]
    code = [path for path in changed if path.endswith(".py")]
    assert not run(tmp_path, "-m", "ruff", "check", "--no-cache", *code)
    assert not run(tmp_path, "-m", "ruff", "format", "--no-cache", "--check", *code)
    proofs = [text for kind, text in blocks if kind == "python"]
    assert proofs, f"{title}: nothing proves the example"
    for proof in proofs:
        assert not run(tmp_path, "-c", proof)
