"""A run folder to which records are added, and the server that shows it."""

import socket
import threading
from contextlib import contextmanager

from gcs.view.live import show

TABLES = ("truth.csv", "reference.csv", "plan.csv")


def write_until(folder, flown, share):
    """Let this share of each table be on record."""
    for name in TABLES:
        content = (flown / name).read_bytes()
        with (folder / name).open("ab") as file:
            file.write(content[file.tell() : round(share * len(content))])


@contextmanager
def served(folder):
    """The server's port, and the event that ends it."""
    is_over = threading.Event()
    listener = socket.create_server(("127.0.0.1", 0))
    server = threading.Thread(target=show, args=(folder, listener, is_over))
    server.start()
    try:
        yield listener.getsockname()[1], is_over
    finally:
        is_over.set()
        server.join()
