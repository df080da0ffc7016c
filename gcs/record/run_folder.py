"""The folder that holds the records of one flight, and its manifest."""

import dataclasses
import enum
import errno
import json
import math
import os
import platform
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from datetime import date, datetime
from functools import cache
from importlib import metadata
from pathlib import Path, PurePath
from typing import Any, Self

import numpy as np

from gcs.errors import UnusableInput
from gcs.numerics import numerics

MANIFEST, SUMMARY = "manifest.json", "summary.json"
FORMAT = 3
"""Version of the format of ``manifest.json``, ``summary.json`` and tables of results; before it was written: 1."""
_DISTRIBUTION = "cooplift"


class UnwritableFile(UnusableInput):
    """A file that cannot be written; ``cause`` is the error of the operating system."""

    def __init__(self, path: Path, cause: OSError) -> None:
        super().__init__(f"{path}: cannot be written: {cause.strerror}")
        self.path, self.cause = path, cause


def open_run_folder(mission_name: str, run_dir: Path | str | None = None, parent: Path | str = "runs") -> Path:
    """Make the folder for the records of one flight, and lock it by an empty manifest.

    Without ``run_dir`` it is ``<parent>/<mission_name>-<number>`` with the next free number; parallel flights never get
    the same one. Raises :class:`UnusableInput` if the folder is not empty, is locked by another flight at the same
    moment, or cannot be written.
    """
    folder = Path(run_dir) if run_dir is not None else _numbered(Path(parent), _plain(mission_name))
    make_folder(folder)
    try:
        if any(folder.iterdir()):
            raise FileExistsError
        (folder / MANIFEST).touch(exist_ok=False)
    except FileExistsError:
        raise _not_empty(folder) from None
    except OSError as error:
        raise _unwritable(folder, error) from None
    return folder


def check_run_folder(run_dir: Path | str | None = None) -> None:
    """Raise :class:`UnusableInput` if :func:`open_run_folder` would, as far as that can be known; makes nothing."""
    check_writable("runs" if run_dir is None else run_dir)
    if run_dir is not None and Path(run_dir).exists() and any(Path(run_dir).iterdir()):
        raise _not_empty(Path(run_dir))


def check_writable(folder: Path | str) -> None:
    """Raise :class:`UnusableInput` for a folder that can be neither written nor made; makes nothing."""
    folder = Path(folder)
    try:
        existing = next(path for path in (folder, *folder.absolute().parents) if path.exists())
        if not existing.is_dir():
            raise UnusableInput(f"{existing}: is a file, not a folder")
        if not os.access(existing, os.R_OK | os.W_OK | os.X_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:  # also a name that is too long
        raise _unwritable(folder, error) from None


class NewRunFolder:
    """A run folder of :func:`open_run_folder`; a context manager that removes it again, unless it is to be kept."""

    def __init__(self, mission_name: str, run_dir: Path | str | None) -> None:
        wanted = Path("runs/flight" if run_dir is None else run_dir)
        above = [folder for folder in wanted.parents if not folder.exists()]
        existed = wanted.exists()
        self.path = open_run_folder(mission_name, run_dir)
        self._made = above if existed else [self.path, *above]
        self._kept = False

    def keep(self) -> None:
        """Keep the folder: from here on there is something to record."""
        self._kept = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if self._kept:
            return
        for entry in self.path.iterdir():  # it was empty
            entry.unlink()
        for folder in self._made:
            with suppress(OSError):  # another flight may have its folder there
                folder.rmdir()


def make_folder(folder: Path | str) -> Path:
    """Make a folder, with those above it, if it is absent. Raises :class:`UnusableInput` if it cannot be made."""
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except FileExistsError:
        raise UnusableInput(f"{folder}: is a file, not a folder") from None
    except OSError as error:
        raise _unwritable(folder, error) from None
    return folder


def _numbered(parent: Path, name: str) -> Path:
    try:
        parent.mkdir(parents=True, exist_ok=True)
        pattern = re.compile(re.escape(name) + r"-(\d+)")
        taken = [int(match[1]) for path in parent.iterdir() if (match := pattern.fullmatch(path.name))]
        number = max(taken, default=0) + 1
        while True:
            try:
                # mkdir is atomic: of two flights at one number, one gets it and the other counts on.
                (parent / f"{name}-{number}").mkdir()
                return parent / f"{name}-{number}"
            except FileExistsError:
                number += 1
    except OSError as error:
        raise _unwritable(parent, error) from None


def _not_empty(folder: Path) -> UnusableInput:
    return UnusableInput(f"{folder}: the run folder is not empty: name another with --run-dir")


def _unwritable(folder: Path, error: OSError) -> UnusableInput:
    return UnusableInput(f"{folder}: the run folder cannot be written: {error.strerror}")


def _plain(mission_name: str) -> str:
    """Return the mission's name as a file name: letters, digits, _ and -; at most 60 characters."""
    return re.sub(r"[^\w-]+", "-", mission_name).strip("-")[:60] or "mission"


def write_manifest(
    folder: Path | str,
    *,
    command: Sequence[str],
    seed: int,
    mission: object,
    system: object,
    start: datetime | str,
) -> Path:
    """Write ``manifest.json``: mission and system as read, versions, numeric libraries, and the time of the start.

    Raises :class:`UnwritableFile`.
    """
    content = {
        "format": FORMAT,
        "command": list(command),
        "seed": seed,
        "start": start,
        "versions": versions(),
        "numerics": numerics(),
        "mission": mission,
        "system": system,
    }
    return write_json(Path(folder) / MANIFEST, content)


def write_json(path: Path | str, content: object) -> Path:
    """Write strict JSON (see :func:`to_json`). Raises :class:`UnwritableFile`."""
    path = Path(path)
    text = json.dumps(to_json(content), indent=2, ensure_ascii=False, allow_nan=False) + "\n"
    # Readers, and those after a killed process, find the old file or the new one, never half of it.
    draft = path.with_name(path.name + ".part")
    try:
        draft.write_text(text, encoding="utf-8")
        draft.replace(path)
    except OSError as error:
        with suppress(OSError):
            draft.unlink(missing_ok=True)
        raise UnwritableFile(path, error) from None
    return path


@cache
def versions() -> Mapping[str, str]:
    """Return the versions of Python, of this package and of its dependencies at run time."""
    found = {"python": platform.python_version()}
    try:
        found[_DISTRIBUTION] = _version(_DISTRIBUTION)
        required = metadata.requires(_DISTRIBUTION) or []
    except metadata.PackageNotFoundError:  # run from a checkout that is not installed
        required = ["matplotlib", "numpy", "pybullet", "proxsuite", "pymavlink", "scipy"]
    for requirement in sorted(required):
        match = re.match(r"[\w.-]+", requirement)
        if match is None or "extra ==" in requirement:
            continue
        try:
            found[match[0]] = _version(match[0])
        except metadata.PackageNotFoundError:
            found[match[0]] = "not installed"
    return found


def _version(distribution: str) -> str:
    """Return the version of a distribution: of its metadata, which are long, the one line."""
    lines = metadata.distribution(distribution).read_text("METADATA") or ""
    match = re.search(r"^Version: *(.+?) *$", lines, re.MULTILINE)
    return match[1] if match else metadata.version(distribution)


def to_json(value: Any) -> Any:
    """Return the same value in terms of strict JSON.

    Dataclasses (their fields that are in the ``repr``) and mappings become objects, arrays, sequences and sets become
    lists, paths and dates text, enumeration members their names; NaN becomes null and infinity the text ``inf`` or
    ``-inf``; anything else its ``str``.
    """
    if value is None or (isinstance(value, (bool, str)) and not isinstance(value, enum.Enum)):
        return value
    if isinstance(value, enum.Enum):
        return value.name
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {field.name: to_json(getattr(value, field.name)) for field in dataclasses.fields(value) if field.repr}
    if isinstance(value, (np.ndarray, np.generic)):
        return to_json(value.tolist())
    if isinstance(value, int):
        return int(value)
    if isinstance(value, float):
        if math.isnan(value):
            return None
        return float(value) if math.isfinite(value) else ("inf" if value > 0 else "-inf")
    if isinstance(value, Mapping):
        return {str(to_json(key)): to_json(item) for key, item in value.items()}
    if isinstance(value, (set, frozenset)):
        return sorted((to_json(item) for item in value), key=str)
    if isinstance(value, Sequence) and not isinstance(value, (bytes, bytearray)):
        return [to_json(item) for item in value]
    if isinstance(value, (date, datetime)):
        return value.isoformat()
    if isinstance(value, PurePath):
        return value.as_posix()
    return str(value)
