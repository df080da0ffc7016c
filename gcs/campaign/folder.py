"""The folder of a campaign, which a process may be killed in at any moment: locked, adopted, written whole."""

import fcntl
import hashlib
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from gcs.errors import UnusableInput
from gcs.record.reader import read_json
from gcs.record.run_folder import make_folder, write_json

SETTINGS = "campaign.json"
_LOCK = ".flying"


@contextmanager
def folder_lock(out: Path) -> Iterator[None]:
    """Lock the folder ``out``, and discard what is left half-flown in ``out/flights``, then and before.

    Raises:
        UnusableInput: Another process has locked it.
    """
    try:
        file = (make_folder(out) / _LOCK).open("a")
    except OSError as error:
        raise UnusableInput(f"{out}: cannot be written: {error.strerror}") from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # released by the system, however the process ends
        except OSError:
            raise UnusableInput(f"{out}: another process is flying there") from None
        try:
            _remove_drafts(out)
            yield
        finally:
            _remove_drafts(out)


def _remove_drafts(out: Path) -> None:
    """Remove the run folders of flights that have not ended."""
    for draft in (out / "flights").glob(".*"):
        remove_folder(draft)


def check_adoptable(folder: Path, settings: Mapping[str, Any]) -> None:
    """Raise :class:`UnusableInput` if ``folder`` holds a campaign of other settings, or something else."""
    path = folder / SETTINGS
    if path.exists():
        found = read_json(path)
        for name, value in settings.items():
            if found.get(name) != value:
                reason = f"was begun with {name} {found.get(name)}, not {value}: name another with --out"
                raise UnusableInput(f"{folder}: {reason}")
    elif folder.is_dir() and any(folder.iterdir()):
        raise UnusableInput(f"{folder}: is neither empty nor the folder of a campaign: name another with --out")


def adopt_folder(folder: Path, settings: Mapping[str, Any]) -> None:
    """Begin a campaign of ``settings`` in ``folder``, or go on with the one that is there.

    Raises:
        UnusableInput: The folder holds a campaign of other settings, or something else.
    """
    check_adoptable(folder, settings)
    if not (make_folder(folder) / SETTINGS).exists():
        write_json(folder / SETTINGS, settings)


def write_text(path: Path, text: str) -> None:
    """Write a file unless it has that content. Raises :class:`UnusableInput`."""
    try:
        if path.exists() and path.read_text(encoding="utf-8") == text:
            return
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None


def remove_folder(folder: Path) -> None:
    """Remove a folder with all that is in it, if there is one."""
    shutil.rmtree(folder, ignore_errors=True)


def shown(path: Path) -> Path:
    """Return a path as it is named in the current folder."""
    here = Path.cwd()
    return path.relative_to(here) if path.is_relative_to(here) else path


def plain(text: str) -> str:
    """Return ``text`` as part of a file name."""
    return re.sub(r"[^\w.]+", "-", text).strip("-.")[:120] or "flight"


def digest(*texts: str) -> str:
    """Return a short text that is another for other texts, as part of a file name."""
    return hashlib.sha256("\0".join(texts).encode()).hexdigest()[:8]
