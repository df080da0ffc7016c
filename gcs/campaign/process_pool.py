"""Parallel flights: each a ``gcs fly`` of a warm worker, all of which end with the process that started them."""

import json
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from gcs.campaign.flight_worker import FlightWorker
from gcs.campaign.folder import remove_folder

P = TypeVar("P")
R = TypeVar("R")

FLIGHT_TIMEOUT = 1800.0
"""s of wall time after which a flight is ended."""
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
        """Reason why the flight was not completed or not flown; else empty."""
        if "reason" in self.summary:
            return str(self.summary["reason"])
        lines = [line for line in self.messages.strip().splitlines() if line.strip()]
        for line in lines:
            if line.startswith(BROKEN_OFF):
                return line.removeprefix(BROKEN_OFF)
        return "" if self.summary or not lines else lines[-1]


def fly_process(mission: Path, options: Sequence[str], run_dir: Path, worker: FlightWorker) -> FlownProcess | None:
    """Fly ``mission`` by ``gcs fly`` with ``options`` into ``run_dir``, which is replaced once the flight has ended.

    Returns:
        None if ``worker.stop`` was set before the flight ended; there is no run folder then.
    """
    begin = time.monotonic()
    draft = run_dir.with_name(f".{run_dir.name}-{os.getpid()}")
    remove_folder(draft)
    arguments = ["fly", str(mission), *options, "--run-dir", str(draft), "--json", "--no-pictures", "--with-parent"]
    exit_code, output, messages = worker.run(arguments, FLIGHT_TIMEOUT)
    if worker.stop.is_set():
        remove_folder(draft)
        return None
    remove_folder(run_dir)
    if draft.exists():
        draft.replace(run_dir)
    summary = _object(output)
    summary.pop("run_dir", None)  # the draft's
    return FlownProcess(exit_code, summary, messages, time.monotonic() - begin)


def end_with_parent() -> None:
    """End this process (``gcs fly --with-parent``) when its standard input ends, which only the parent can cause.

    The simulator reads the same of this process, and ends as well.
    """

    def watch() -> None:
        while os.read(sys.stdin.fileno(), 1):
            pass
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


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
    fly: Callable[[P, FlightWorker], R | None],
    started: Callable[[P], None],
    ended: Callable[[P, R], None],
) -> None:
    """Call ``fly(plan, worker)`` for each of ``plans``, ``jobs`` at a time; an interrupt ends all.

    ``fly`` has the worker for itself, and returns None if ``worker.stop`` was set before the flight ended. Both
    callbacks are called in the caller's thread.
    """
    waiting = list(plans)
    stop = threading.Event()
    flying: dict[Future[R | None], tuple[P, FlightWorker]] = {}
    with ExitStack() as resources:
        idle = [resources.enter_context(FlightWorker(stop)) for _ in range(min(jobs, len(waiting)))]
        pool = resources.enter_context(ThreadPoolExecutor(jobs))
        try:
            while waiting or flying:
                while waiting and idle:
                    plan, worker = waiting.pop(0), idle.pop()
                    flying[pool.submit(fly, plan, worker)] = plan, worker
                    started(plan)
                finished, _ = wait(flying, timeout=1.0, return_when=FIRST_COMPLETED)
                for future in finished:
                    plan, worker = flying.pop(future)
                    idle.append(worker)
                    if (result := future.result()) is not None:
                        ended(plan, result)
        finally:
            stop.set()
