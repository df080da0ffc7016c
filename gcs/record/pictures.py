"""Writing a picture."""

from __future__ import annotations

from pathlib import Path

from matplotlib.figure import Figure

from gcs.errors import UnusableInput


def save_picture(figure: Figure, path: Path, dpi: int) -> Path:
    """Write a figure to ``path`` and return it. Raises :class:`UnusableInput` if it cannot be written."""
    try:
        figure.savefig(path, dpi=dpi)
    except OSError as error:
        raise UnusableInput(f"{path}: cannot be written: {error.strerror}") from None
    return path
