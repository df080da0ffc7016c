"""docs/tutorial.md does what it says: its files are saved, its commands run, and its output is what they print.

A block follows a line that names its file ("as `yard.toml`:" or "to the end of `yard.toml`:"), or is a command (sh), or
what the command before it prints (text): "..." stands for anything, and figures may change a little with the stack.
"""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

PAGE = Path(__file__).parents[2] / "docs" / "tutorial.md"
NOT_RUN = ("git clone", "make ")  # they install, and fly a mission that other tests fly
TOLERANCE = 0.2  # of a printed figure

_BLOCK = re.compile(r"^```(?P<language>\w+)\n(?P<text>.*?)^```$", re.MULTILINE | re.DOTALL)
_FILE = re.compile(r"(?P<how>as|to the end of) `(?P<name>[\w.]+)`:$")
_FIGURE = r"\d+(?:\.\d+)?"


def blocks(page):
    """Blocks of the page in their order: what is done with each, a file's name, the text."""
    for block in _BLOCK.finditer(page):
        file = _FILE.search(page[: block.start()].rstrip())
        if block["language"] in ("sh", "text"):
            yield block["language"], "", block["text"]
        else:
            assert file, f"which file is this?\n{block['text']}"
            yield file["how"], file["name"], block["text"]


def script(page):
    """All of the page for one shell, which stops at what fails; ``output.N`` is what the Nth commands print."""
    lines, number = ["set -e"], 0
    for what, name, text in blocks(page):
        if what == "sh":
            commands = [line for line in text.splitlines() if not line.startswith(NOT_RUN)]
            lines += ["{ :", *commands, f'}} > "$OUTPUT.{number}" 2>&1']
            number += 1
        elif what != "text":
            lines += [f"cat {'>' if what == 'as' else '>>'} {name} <<'END'", text + "END"]
    return "\n".join(lines)


def differences(expected, printed):
    """What of the text of a page is not what was printed; none: it is."""
    parts = re.split(rf"(\.\.\.|{_FIGURE}|\s+)", expected.strip())
    patterns = [
        ".*" if part == "..." else rf"({_FIGURE})" if re.fullmatch(_FIGURE, part)
        else r"\s+" if part.isspace() else re.escape(part)
        for part in parts if part
    ]  # fmt: skip
    found = re.fullmatch(r"\s*" + "".join(patterns) + r"\s*", printed, re.DOTALL)
    if not found:
        return f"expected:\n{expected}\nprinted:\n{printed}"
    figures = [float(part) for part in parts if re.fullmatch(_FIGURE, part)]
    wrong = [
        f"{figure} printed as {text}" for figure, text in zip(figures, found.groups(), strict=True)
        if abs(float(text) - figure) > TOLERANCE * figure
    ]  # fmt: skip
    return "\n".join(wrong)


@pytest.mark.slow
@pytest.mark.long  # what its commands do is tested one by one
def test_tutorial_works_as_written(tmp_path):
    page = PAGE.read_text(encoding="utf-8")
    clone = tmp_path / "clone"
    clone.mkdir()
    (clone / ".venv").symlink_to(sys.prefix)
    environment = {**os.environ, "OUTPUT": str(tmp_path / "output"), "COLUMNS": "80", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(["bash", "-c", script(page)], cwd=clone, env=environment, check=False)
    outputs = sorted(tmp_path.glob("output.*"), key=lambda path: int(path.suffix[1:]))
    printed = [path.read_text(encoding="utf-8") for path in outputs]
    assert done.returncode == 0, printed[-1]
    number, compared = -1, 0
    for what, _, text in blocks(page):
        number += what == "sh"
        if what == "text":
            assert differences(text, printed[number]) == ""
            compared += 1
    assert number + 1 == len(printed) and compared >= 3
    assert (tmp_path / "yard" / "yard.png").exists()
