"""End of a simulator: on a signal, or when the process that started it has ended."""

import contextlib
import os
import select
import signal
import socket
from collections.abc import Iterator
from types import FrameType
from typing import Protocol

INTERRUPTED = 130
"""Exit status after Ctrl-C, and after SIGHUP of a closed terminal."""


class _HasFileno(Protocol):
    def fileno(self) -> int: ...


class Ending:
    """The request to end, and a wait for datagrams that does not miss it.

    ``requested``: end now, with the exit status ``status``. ``parent_gone``: let the vehicles land, then end.
    ``has_parent``: another process owns this one and has ended when ``parent``, a pipe from it, is at its end.
    """

    def __init__(self, parent: int | None = None) -> None:
        """``parent``: file descriptor of the pipe, None without one."""
        self.requested = False
        self.status = 0
        self.parent_gone = False
        self.has_parent = parent is not None
        self._parent = parent
        self._waker, self._woken = socket.socketpair()
        self._waker.setblocking(False)
        self._woken.setblocking(False)

    def request(self, status: int = 0) -> None:
        """End now; from any thread."""
        self.requested = True
        self.status = status
        with contextlib.suppress(OSError):
            self._waker.send(b"!")

    def wait(self, sockets: list[socket.socket], timeout: float | None) -> None:
        """Until a socket has something to read, the end has come nearer, or ``timeout`` (s) has passed."""
        if self.requested:
            return
        watched: list[_HasFileno | int] = [self._woken, *sockets]
        if self._parent is not None and not self.parent_gone:
            watched.append(self._parent)
        readable = select.select(watched, (), (), timeout)[0]
        if self._parent in readable:
            self._read_parent()

    def look(self) -> None:
        """Check at once whether the parent has ended."""
        self.wait([], 0.0)

    @contextlib.contextmanager
    def on_signals(self) -> Iterator[None]:
        """Ctrl-C, SIGTERM and SIGHUP request the end while the block runs; main thread only.

        With a parent, Ctrl-C and a closed terminal are the parent's business: a terminal sends both signals to both.
        """
        handlers = {signal.SIGTERM: signal.signal(signal.SIGTERM, self._on_signal)}
        for number in (signal.SIGINT, signal.SIGHUP):
            if number == signal.SIGINT or signal.getsignal(number) != signal.SIG_IGN:  # as nohup has it
                handlers[number] = signal.signal(number, signal.SIG_IGN if self.has_parent else self._on_signal)
        try:
            yield
        finally:
            for number, handler in handlers.items():
                signal.signal(number, handler)

    def close(self) -> None:
        """Release the file descriptors; harmless when that is done."""
        self._waker.close()
        self._woken.close()

    def _on_signal(self, number: int, frame: FrameType | None) -> None:
        self.request(0 if number == signal.SIGTERM else INTERRUPTED)

    def _read_parent(self) -> None:
        try:
            self.parent_gone = self._parent is None or not os.read(self._parent, 4096)
        except BlockingIOError:
            pass
        except OSError:
            self.parent_gone = True
