"""Writing an exported file: whole or not at all."""

from contextlib import suppress
from pathlib import Path

from gcs.record.run_folder import UnwritableFile


def write_file(path: Path, content: bytes) -> Path:
    """Write a file, in place of an earlier one, and return its path. Raises :class:`UnwritableFile`."""
    draft = path.with_name(path.name + ".part")
    try:
        draft.write_bytes(content)
        draft.replace(path)
    except OSError as error:
        with suppress(OSError):
            draft.unlink(missing_ok=True)
        raise UnwritableFile(path, error) from None
    return path
