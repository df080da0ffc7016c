"""Parallel flights: each a ``gcs fly`` process, all of which end with the process that started them."""

import json
import os
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from gcs.campaign.folder import remove_folder

P = TypeVar("P")
R = TypeVar("R")

FLIGHT_TIMEOUT = 1800.0
"""s of wall time after which a flight is ended."""
POLL = 0.2  # s
BROKEN_OFF = "flight broken off: "


@dataclass(frozen=True)
class FlownProcess:
    """Result of a ``gcs fly``: its summary, empty if it has none, its standard error, and its wall time (s)."""

    exit_code: int
    summary: dict[str, Any]
    messages: str
    wall: float

    @property
    def reason(self) -> str:
        """Reason why the flight was aborted or not flown; else empty."""
        lines = [line for line in self.messages.strip().splitlines() if line.strip()]
        for line in lines:
            if line.startswith(BROKEN_OFF):
                return line.removeprefix(BROKEN_OFF)
        return "" if self.summary or not lines else lines[-1]


def fly_process(mission: Path, options: Sequence[str], run_dir: Path, stop: threading.Event) -> FlownProcess | None:
    """Fly ``mission`` by ``gcs fly`` with ``options`` into ``run_dir``, which is replaced once the flight has ended.

    Returns:
        None if ``stop`` was set before the flight ended; there is no run folder then.
    """
    begin = time.monotonic()
    draft = run_dir.with_name(f".{run_dir.name}-{os.getpid()}")
    command = [sys.executable, "-m", "gcs", "fly", str(mission), *options]
    command += ["--run-dir", str(draft), "--json", "--no-pictures", "--with-parent"]
    remove_folder(draft)
    # The flight holds the other end and reads its end of file when this process ends, however it does.
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
        output, messages = _output(process, stop, begin + FLIGHT_TIMEOUT)
    finally:
        os.close(ours)
    if stop.is_set():
        remove_folder(draft)
        return None
    remove_folder(run_dir)
    if draft.exists():
        draft.replace(run_dir)
    return FlownProcess(process.returncode, _object(output), messages, time.monotonic() - begin)


def end_with_parent() -> None:
    """End this process (``gcs fly --with-parent``) when its standard input ends, which only the parent can cause.

    The simulator reads the same of this process, and ends as well.
    """

    def watch() -> None:
        while os.read(sys.stdin.fileno(), 1):
            pass
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def _output(process: subprocess.Popen[str], stop: threading.Event, deadline: float) -> tuple[str, str]:
    """Return what the process wrote until it ended, or was ended."""
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
    """Return the number of parallel flights by default."""
    return len(os.sched_getaffinity(0))


def run_parallel(
    plans: Sequence[P],
    jobs: int,
    fly: Callable[[P, threading.Event], R | None],
    started: Callable[[P], None],
    ended: Callable[[P, R], None],
) -> None:
    """Call ``fly(plan, stop)`` for each of ``plans``, ``jobs`` at a time; an interrupt ends all.

    ``fly`` returns None if ``stop`` was set before the flight ended. Both callbacks are called in the caller's thread.
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
