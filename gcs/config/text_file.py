"""Text files, read whole."""

from pathlib import Path

from gcs.config.validate import UnusableFile

SIZE_LIMIT = 8_000_000
"""Bytes. The longest missions that ground stations write are a few hundred kilobytes."""


def why_unparsed(error: ValueError | RecursionError) -> str:
    """Return why a parser has refused a text, without Python's advice to programmers."""
    if isinstance(error, RecursionError):
        return "nested too deeply"
    text = str(getattr(error, "msg", error))
    return "a number has too many digits" if "integer string conversion" in text else text


def read_text(path: Path) -> str:
    """Return the text of a UTF-8 file, with or without a byte order mark. Line ends as in the file.

    Raises :class:`UnusableFile` when it cannot be read, is too large, or is not text.
    """
    try:
        if path.is_dir():
            raise UnusableFile([f"{path}: is a folder, not a file"])
        with path.open("rb") as file:
            content = file.read(SIZE_LIMIT + 1)
    except (OSError, ValueError) as error:  # ValueError: a path with a null character
        raise UnusableFile([f"{path}: cannot be read: {getattr(error, 'strerror', None) or error}"]) from error
    if len(content) > SIZE_LIMIT:
        raise UnusableFile([f"{path}: larger than {SIZE_LIMIT // 1_000_000} MB"])
    try:
        text = content.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise UnusableFile([f"{path}: line {line}: not UTF-8 text"]) from error
    if not text.strip():
        raise UnusableFile([f"{path}: the file is empty"])
    return text
