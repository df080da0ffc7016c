"""What the pages of the documents share: places for tables, tables in Markdown, and the commit that made them."""

import subprocess
from collections.abc import Mapping, Sequence
from pathlib import Path

from gcs.campaign.flight import PACKAGES
from gcs.campaign.folder import digest
from gcs.errors import UnusableInput

FLOWN = (*PACKAGES, "missions", "pyproject.toml")
"""What decides how a flight ends, in the project's folder."""


def commit_of(folder: Path) -> str:
    """Return the last commit that changed what is flown, and a digest of the changes since.

    ``folder``: one in the project's folder.
    """
    try:
        commit, changes = (
            subprocess.run(["git", *arguments, "--", *FLOWN], cwd=folder.parent, check=True, capture_output=True,
                text=True).stdout
            for arguments in (("log", "-1", "--format=%h"), ("diff", "HEAD"))
        )  # fmt: skip
    except (OSError, subprocess.CalledProcessError):
        return "an unknown commit"
    return f"commit {commit.strip()}" + (f" with changes {digest(changes)}" if changes else "")


def markdown_table(rows: Sequence[Mapping[str, str]]) -> str:
    """Return ``rows``, cells by title, one at least, as a table in Markdown."""
    head, *lines = (f"| {' | '.join(cells)} |\n" for cells in (rows[0], *(row.values() for row in rows)))
    return "".join([head, f"|{'---|' * len(rows[0])}\n", *lines])


def renewed(page: str, name: str, text: str) -> str:
    """Return the page with ``text`` between the comments that begin and end the place ``name``.

    Raises :class:`UnusableInput` for a page without them.
    """
    begin, end = f"<!-- {name} -->\n", f"<!-- end of {name} -->"
    if page.count(begin) != 1 or page.count(end) != 1 or page.index(begin) > page.index(end):
        raise UnusableInput(f"the page has no place for the {name}: needs a line {begin.strip()} and a line {end}")
    head, rest = page.split(begin)
    return f"{head}{begin}{text}{end}{rest.split(end)[1]}"


def made_by(command: str, commit: str, table: str) -> str:
    """Return a table below the command that made it."""
    return f"\nMade by `{command}` at {commit}:\n\n{table}\n"
