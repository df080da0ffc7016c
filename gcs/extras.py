"""Packages that one rare path needs, installed as an extra of the distribution."""

from collections.abc import Iterator
from contextlib import contextmanager

from gcs.errors import UnusableInput


@contextmanager
def extra(name: str, what: str) -> Iterator[None]:
    """Import within what the extra ``name`` installs; ``what`` needs it.

    Raises :class:`UnusableInput` with the extra's name where it is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        raise UnusableInput(f"{what}: needs {error.name}: pip install 'cooplift[{name}]'") from None
