"""Output of the physics engine, below Python's streams, kept out of the program's output."""

import contextlib
import os
import sys
from collections.abc import Iterator

_OUTPUT, _ERRORS = 1, 2


@contextlib.contextmanager
def messages_of_engine_aside() -> Iterator[None]:
    """Redirect standard output to standard error."""
    sys.stdout.flush()
    with _redirected(_OUTPUT, os.dup(_ERRORS)):
        yield


@contextlib.contextmanager
def greeting_of_engine_dropped() -> Iterator[None]:
    """Discard what the import of the engine prints to standard error: its build date."""
    with _redirected(_ERRORS, os.open(os.devnull, os.O_WRONLY)):
        yield


@contextlib.contextmanager
def _redirected(stream: int, target: int) -> Iterator[None]:
    """``stream`` writes to ``target`` (which is taken over) while the block runs."""
    try:
        kept = os.dup(stream)
    except OSError:  # it is closed: nothing gets out anyway
        os.close(target)
        yield
        return
    os.dup2(target, stream)
    os.close(target)
    try:
        yield
    finally:
        os.dup2(kept, stream)
        os.close(kept)
