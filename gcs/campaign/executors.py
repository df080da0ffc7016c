"""What carries out the calls of a campaign: an executor of this machine's processes, or any other one."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor
from itertools import islice
from multiprocessing import get_context
from multiprocessing.connection import Connection
from queue import SimpleQueue
from typing import Any, TypeVar

from gcs.errors import GcsError
from gcs.numerics import choose_kernels

T = TypeVar("T")
R = TypeVar("R")

WINDOW = 1000
"""Calls that an executor holds at a time."""
ATTEMPTS = 2
"""Calls whose processes are killed before one is not repeated."""
_SPAWN = get_context("spawn")


def all_cores() -> int:
    """Return the number of processes by default."""
    return len(os.sched_getaffinity(0))


class WorkerProcesses(Executor):
    """Processes of this machine, one call at a time in each; one that is killed fails no call but its own.

    A process serves many calls. All end with the process that started them, however that ends, and with
    ``shutdown(wait=False)`` at once.
    """

    def __init__(self, count: int | None = None) -> None:
        """``count``: of the processes; None: one per core."""
        self._idle: list[ProcessPoolExecutor] = []
        self._ended, self._running = _SPAWN.Pipe(duplex=False)
        self._threads = ThreadPoolExecutor(count or all_cores())

    def submit(self, call: Callable[..., R], /, *args: Any, **keywords: Any) -> Future[R]:
        """Carry out ``call`` in a process; its future raises :class:`BrokenExecutor` if that was killed."""
        return self._threads.submit(self._carried_out, call, *args, **keywords)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Wait for the calls under way, or end them with their processes; then end the processes."""
        if not wait:
            self._running.close()
        self._threads.shutdown(cancel_futures=cancel_futures or not wait)
        while self._idle:
            self._idle.pop().shutdown()
        self._running.close()

    def _carried_out(self, call: Callable[..., R], /, *args: Any, **keywords: Any) -> R:
        try:
            process = self._idle.pop()
        except IndexError:
            choose_kernels()
            process = ProcessPoolExecutor(1, _SPAWN, _end_with, (self._ended,))
            # Inherited by the process: Ctrl-C and a closed terminal are for the one that started it.
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGHUP})
        try:
            result = process.submit(call, *args, **keywords).result()
        except BrokenExecutor:
            process.shutdown()
            raise
        except BaseException:
            self._idle.append(process)
            raise
        self._idle.append(process)
        return result


def _end_with(other: Connection) -> None:
    """End this process when the other end of the connection is closed."""

    def watch() -> None:
        other.poll(None)
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()


def carry_out(
    executor: Executor, call: Callable[[T], R], tasks: Iterable[T], ended: Callable[[T, R | None], None]
) -> None:
    """Carry out ``call(task)`` for each task; ``ended`` receives it with the result, in the caller's thread.

    A call whose process was killed is repeated; if that is killed, too, the result is None. With any other exception,
    an interrupt too, the calls under way are abandoned, and the executor is shut down. Raises :class:`GcsError` when
    the executor drops the calls.
    """
    done: SimpleQueue[Future[R]] = SimpleQueue()
    under_way: dict[Future[R], tuple[T, int]] = {}

    def submit(task: T, attempt: int = 1) -> None:
        future = executor.submit(call, task)
        under_way[future] = task, attempt
        future.add_done_callback(done.put)

    waiting = iter(tasks)
    try:
        for task in islice(waiting, WINDOW):
            submit(task)
        while under_way:
            future = done.get()
            task, attempt = under_way.pop(future)
            result: R | None = None
            try:
                result = future.result()
            except BrokenExecutor:
                if attempt < ATTEMPTS:
                    submit(task, attempt + 1)
                    continue
            except CancelledError:
                raise GcsError("the scheduler has ended or has dropped the flights: start again to resume") from None
            except Exception as error:
                if type(error).__name__ != "KilledWorker":  # with which Dask gives up, after attempts of its own
                    raise
            ended(task, result)
            for another in islice(waiting, 1):
                submit(another)
    except BaseException:
        for future in [*under_way]:
            future.cancel()
        executor.shutdown(wait=False)
        raise
