"""The report page of a run while it is flown: a server of this machine that sends what has come to be on record.

A program of its own, started by :mod:`gcs.drivers.live_view`: it reads the run folder, so that nothing that flies waits
for it. It ends, with the whole report, when its standard input does.
"""

from __future__ import annotations

import logging
import os
import socket
import sys
import threading
import time
from contextlib import suppress
from http import HTTPStatus
from pathlib import Path

import numpy as np
import orjson
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed
from websockets.http11 import Request, Response
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Origin

from gcs.errors import GcsError
from gcs.record.growing import GrowingTables
from gcs.record.run_data import read_run
from gcs.record.tables import TRUTH
from gcs.view.page import page
from gcs.view.page_data import PageData

PERIOD = 0.2
"""Time between two messages (s)."""
CPU_SHARE = 0.2
"""Of one core at most, by a longer time between messages: those of a long flight take longer."""
NICENESS = 10
END_TIMEOUT = 20.0
"""Time for the whole report to reach the browsers (s); one that does not take it is left."""


class Records:
    """What is on record of a run, from one message to the next."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._tables = GrowingTables(folder)

    def message(self) -> str | None:
        """Return what is new (JSON: ``header`` and ``blob`` of :class:`PageData`, ``final``); None: nothing yet."""
        self._tables.grow()
        new = read_run(self._folder, self._tables.new())
        # Without new rows of the truth those of the estimate would be taken for what was flown.
        if not len(new.time) or new.source != ("truth" if len(self._tables[TRUTH]) else "estimate"):
            return None
        message = _message(PageData(new, self._tables), final=False)
        self._tables.take()
        return message

    def final(self) -> str | None:
        """Return all of the run, which is over; None where nothing was flown."""
        run = read_run(self._folder)
        return _message(PageData(run), final=True) if len(run.time) else None


def _message(data: PageData, *, final: bool) -> str:
    content = {"header": data.header, "blob": data.blob, "final": final}
    return orjson.dumps(content, default=np.ndarray.tolist, option=orjson.OPT_SERIALIZE_NUMPY).decode()


def show(folder: Path, listener: socket.socket, is_over: threading.Event) -> None:
    """Serve the page of a run folder and, by web socket, its messages, until ``is_over`` and all is sent.

    ``listener`` listens on this machine alone. What a browser sends is not read; pages of others are refused.
    """
    port = listener.getsockname()[1]
    text = page("live view", '<script type="application/json" class="live">{}</script>').encode()

    def answer(_: ServerConnection, request: Request) -> Response | None:
        if "Upgrade" in request.headers:
            return None
        found = request.path == "/"
        status, body = (HTTPStatus.OK, text) if found else (HTTPStatus.NOT_FOUND, b"")
        headers = Headers({"Content-Type": "text/html; charset=utf-8", "Content-Length": str(len(body))})
        return Response(status, status.phrase, headers, body)

    senders: list[threading.Thread] = []

    def send(connection: ServerConnection) -> None:
        senders.append(threading.current_thread())
        records = Records(folder)
        with suppress(ConnectionClosed, GcsError):
            while not is_over.is_set():
                begun = time.thread_time()
                if (message := records.message()) is not None:
                    connection.send(message)
                is_over.wait(max(PERIOD, (time.thread_time() - begun) / CPU_SHARE))
            if (message := records.final()) is not None:
                connection.send(message)

    own = [None, *(Origin(f"http://{host}:{port}") for host in ("127.0.0.1", "localhost"))]
    # What is no web socket's opening, from whatever calls here, is no matter for the terminal.
    logger = logging.getLogger("websockets.server")
    logger.setLevel(logging.CRITICAL)
    with serve(send, sock=listener, origins=own, process_request=answer, logger=logger, compression=None) as server:
        threading.Thread(target=server.serve_forever).start()
        is_over.wait()
        for sender in senders:
            sender.join()


def main(arguments: list[str]) -> None:
    """Show the run folder that is named first, at the listening socket whose number follows, until the input ends."""
    os.nice(NICENESS)
    is_over = threading.Event()

    def wait_for_end() -> None:
        with suppress(OSError):
            while sys.stdin.buffer.read(1):
                pass
        is_over.set()
        time.sleep(END_TIMEOUT)
        os._exit(1)  # a sender waits for a browser that does not read

    threading.Thread(target=wait_for_end, daemon=True).start()
    show(Path(arguments[0]), socket.socket(fileno=int(arguments[1])), is_over)


if __name__ == "__main__":
    main(sys.argv[1:])
