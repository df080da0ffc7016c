"""Packages that are installed apart: those of an extra that one rare path needs, and simulators by entry points."""

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.metadata import EntryPoint, entry_points

from gcs.errors import GcsError, UnusableInput

DEFAULT_SIMULATOR = "pybullet"


@contextmanager
def extra(name: str, what: str) -> Iterator[None]:
    """Import within what the extra ``name`` installs; ``what`` needs it.

    Raises :class:`UnusableInput` with the extra's name where it is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        raise UnusableInput(f"{what}: needs {error.name}: pip install 'cooplift[{name}]'") from None


def simulator(group: str, what: str) -> EntryPoint:
    """Return the entry point of ``group`` that is installed: :data:`DEFAULT_SIMULATOR`, or the only one.

    Raises :class:`GcsError` where there is none: ``what`` is missing.
    """
    found = entry_points(group=group)
    if not found:
        raise GcsError(f"no simulated {what} installed (entry points {group}): install cooplift again")
    return found[DEFAULT_SIMULATOR] if DEFAULT_SIMULATOR in found.names else next(iter(found))
