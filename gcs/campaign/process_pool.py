"""Many flights side by side: each a ``gcs fly`` of its own, each result kept as soon as it is there.

Random courses, studies and fault campaigns are flown by this. Whoever does is free to be killed at any moment: results
are written whole or not at all, a run folder gets its name when its flight has ended, flights end with the process that
started them, and of two processes only one flies in a folder.
"""

from __future__ import annotations

import csv
import fcntl
import json
import os
import shutil
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from gcs.errors import UnusableInput
from gcs.record.run_folder import make_folder

P = TypeVar("P")
R = TypeVar("R")

KEPT = ("failures", "all", "none")
"""Whose run folders are kept."""
MOST_WALL_TIME = 1800.0
"""s of wall time after which a flight is given up."""
POLL = 0.2  # s
BROKEN_OFF = "flight broken off: "
_LOCK = ".flying"


@dataclass(frozen=True)
class Ended:
    """How a ``gcs fly`` ended: its summary, empty if it has none, what it said, and how long it took (s)."""

    exit_code: int
    summary: dict[str, Any]
    said: str
    wall: float

    @property
    def reason(self) -> str:
        """Why it was broken off, or not flown at all."""
        lines = [line for line in self.said.strip().splitlines() if line.strip()]
        for line in lines:
            if line.startswith(BROKEN_OFF):
                return line.removeprefix(BROKEN_OFF)
        return "" if self.summary or not lines else lines[-1]


def fly_process(mission: Path, options: Sequence[str], run_dir: Path, stop: threading.Event) -> Ended | None:
    """Fly ``mission`` by ``gcs fly`` with ``options`` into ``run_dir``, in place of what is there.

    None if ``stop`` was set before it ended; then there is no run folder.
    """
    begin = time.monotonic()
    draft = run_dir.with_name(f".{run_dir.name}-{os.getpid()}")
    command = [sys.executable, "-m", "gcs", "fly", str(mission), *options]
    command += ["--run-dir", str(draft), "--json", "--no-pictures", "--with-parent"]
    remove_folder(draft)
    # The flight has the one end and reads its end of file when this process is no more, however that came about.
    theirs, ours = os.pipe()
    try:
        process = subprocess.Popen(
            command,
            stdin=theirs,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,  # Ctrl-C is for this process, which ends its flights itself
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"},
        )
        os.close(theirs)
        output, said = _output(process, stop, begin + MOST_WALL_TIME)
    finally:
        os.close(ours)
    if stop.is_set():
        remove_folder(draft)
        return None
    remove_folder(run_dir)
    if draft.exists():
        draft.replace(run_dir)
    return Ended(process.returncode, _object(output), said, time.monotonic() - begin)


def end_with_parent() -> None:
    """For ``gcs fly --with-parent``: end at once when standard input does, which only the parent can cause.

    The simulator reads the same of this process, and ends as well.
    """

    def watch() -> None:
        while os.read(sys.stdin.fileno(), 1):
            pass
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _output(process: subprocess.Popen[str], stop: threading.Event, deadline: float) -> tuple[str, str]:
    """What the process wrote until it ended, or was ended."""
    while True:
        try:
            return process.communicate(timeout=POLL)
        except subprocess.TimeoutExpired:
            if stop.is_set() or time.monotonic() > deadline:
                process.kill()  # the simulator ends with it: it reads the end of its standard input


def _object(text: str) -> dict[str, Any]:
    try:
        content = json.loads(text)
    except ValueError:
        return {}
    return content if isinstance(content, dict) else {}


def all_cores() -> int:
    """How many flights go side by side where it is not said."""
    return len(os.sched_getaffinity(0))


def fly_side_by_side(
    plans: Sequence[P],
    jobs: int,
    fly: Callable[[P, threading.Event], R | None],
    started: Callable[[P], None],
    ended: Callable[[P, R], None],
) -> None:
    """``fly(plan, stop)`` for each of ``plans``, ``jobs`` at a time.

    It gives None if ``stop`` was set before the flight ended. Both callbacks are called in the caller's thread. An
    interrupt ends all flights.
    """
    waiting = list(plans)
    stop = threading.Event()
    flying: dict[Future[R | None], P] = {}
    with ThreadPoolExecutor(jobs) as pool:
        try:
            while waiting or flying:
                while waiting and len(flying) < jobs:
                    plan = waiting.pop(0)
                    flying[pool.submit(fly, plan, stop)] = plan
                    started(plan)
                finished, _ = wait(flying, timeout=1.0, return_when=FIRST_COMPLETED)
                for future in finished:
                    plan = flying.pop(future)
                    if (result := future.result()) is not None:
                        ended(plan, result)
        finally:
            stop.set()


@contextmanager
def sole_flyer(out: Path) -> Iterator[None]:
    """While one process flies in the folder ``out``, another is refused: :class:`UnusableInput`.

    What a killed one left half-flown in ``out/flights`` is removed.
    """
    try:
        file = (make_folder(out) / _LOCK).open("a")
    except OSError as error:
        raise UnusableInput(f"{out}: cannot be written: {error.strerror}") from None
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)  # given back by the system, however the process ends
        except OSError:
            raise UnusableInput(f"{out}: another process is flying there") from None
        for draft in (out / "flights").glob(".*"):
            remove_folder(draft)
        yield


def claim_folder(path: Path, settings: Mapping[str, Any], write: Callable[[Path, Any], Any]) -> None:
    """The folder of the file ``path`` belongs to whoever has the same ``settings``, which it holds.

    Raises :class:`UnusableInput` for a folder of other settings, or of something else.
    """
    folder = make_folder(path.parent)
    if path.exists():
        found = read_object(path)
        for name, value in settings.items():
            if found.get(name) != value:
                reason = f"was begun with {name} {found.get(name)}, not {value}: name another with --out"
                raise UnusableInput(f"{folder}: {reason}")
    elif any(folder.iterdir()):
        raise UnusableInput(f"{folder}: is neither empty nor the folder of a campaign")
    else:
        write(path, settings)


def read_object(path: Path) -> dict[str, Any]:
    """A file of one JSON object; empty if it is anything else. Raises :class:`UnusableInput` where it cannot."""
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise UnusableInput(f"{path}: cannot be read: {error}") from None
    return content if isinstance(content, dict) else {}


def drops_run_folder(keep: str, passed: bool) -> bool:
    """Whether the run folder of a flight is not kept, by ``keep``, one of :data:`KEPT`."""
    return keep == "none" or (keep == "failures" and passed)


def remove_folder(folder: Path) -> None:
    """Remove a folder with all that is in it, if there is one."""
    shutil.rmtree(folder, ignore_errors=True)


def write_table(path: Path, columns: Sequence[str], rows: Sequence[Mapping[str, Any]]) -> Path:
    """Write a CSV file. Raises :class:`UnusableInput` where it cannot."""
    try:
        with path.open("w", newline="", encoding="utf-8") as file:
            writer = csv.DictWriter(file, columns)
            writer.writeheader()
            writer.writerows(rows)
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None
    return path
