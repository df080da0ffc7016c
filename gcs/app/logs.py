"""Logging of the programs: one logger a package, warnings on standard error, on request more of it and a file.

The loggers are ``logging.getLogger("gcs")`` (:data:`LOG`) and ``logging.getLogger("vehicle_sim")``. Phases, mode
changes and connections are INFO, alarms and failsafes WARNING, the reason for an abort ERROR, link and clock events
DEBUG.
"""

import argparse
import logging
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TextIO

LOGGERS = ("gcs", "vehicle_sim")
LOG = logging.getLogger("gcs")
_LEVELS = (logging.ERROR, logging.WARNING, logging.INFO, logging.DEBUG)
_DEFAULT = _LEVELS.index(logging.WARNING)
_FILE_FORMAT = "%(asctime)s.%(msecs)03d %(levelname)-7s %(name)s: %(message)s"


def add_log_arguments(parser: argparse.ArgumentParser) -> None:
    """Add ``-v``, ``-q`` and ``--log-file``."""
    group = parser.add_argument_group("logging")
    group.add_argument(
        "-v",
        "--verbose",
        action="count",
        default=0,
        help="all figures, phases and modes; -vv: links and clocks",
    )
    group.add_argument("-q", "--quiet", action="count", default=0, help="log errors only, no warnings")
    group.add_argument("--log-file", type=_log_file, metavar="FILE", help="append the log, at every level, to FILE")


@contextmanager
def logging_to(arguments: argparse.Namespace) -> Iterator[None]:
    """Log by the arguments of :func:`add_log_arguments`, and not as before, until the context ends."""
    console = _StandardError()
    console.setLevel(_LEVELS[min(max(_DEFAULT + arguments.verbose - arguments.quiet, 0), len(_LEVELS) - 1)])
    handlers: list[logging.Handler] = [console]
    if arguments.log_file is not None:
        file = _LogFile(arguments.log_file, encoding="utf-8")
        file.setLevel(logging.DEBUG)
        file.setFormatter(logging.Formatter(_FILE_FORMAT, "%Y-%m-%d %H:%M:%S"))
        handlers.append(file)
    with ExitStack() as context:
        for handler in handlers:
            context.callback(handler.close)
        for name in LOGGERS:
            logger = logging.getLogger(name)
            context.callback(logger.setLevel, logger.level)
            logger.setLevel(min(handler.level for handler in handlers))
            context.callback(setattr, logger, "handlers", logger.handlers)
            logger.handlers = list(handlers)
        yield


def _log_file(text: str) -> Path:
    """Return an argument that names a file to append to."""
    path = Path(text)
    try:
        existed = path.exists()
        with path.open("a", encoding="utf-8"):
            pass
        if not existed:  # the command may yet be refused
            path.unlink()
        return path
    except OSError as error:
        raise argparse.ArgumentTypeError(f"{text}: cannot be written: {error.strerror}") from None


class _LogFile(logging.FileHandler):
    """Handler of a log file, which may end before the program: a full disk."""

    _ended = False

    def handleError(self, record: logging.LogRecord) -> None:
        """Say so, once."""
        if not self._ended:
            self._ended = True
            print(f"{self.baseFilename}: the log ends here: {sys.exc_info()[1]}", file=sys.stderr)

    def close(self) -> None:
        """Close the file; what is buffered may be lost."""
        with suppress(OSError):
            super().close()


class _StandardError(logging.StreamHandler[TextIO]):
    """Handler of the present standard error, for a progress display may have taken its place."""

    def __init__(self) -> None:
        super().__init__(sys.stderr)

    def emit(self, record: logging.LogRecord) -> None:
        self.stream = sys.stderr
        super().emit(record)

    def format(self, record: logging.LogRecord) -> str:
        """Return the line, in the colour of the record where a progress display prints it, which knows the terminal."""
        text, colour = super().format(record), getattr(record, "colour", None)
        return f"\x1b[{colour}m{text}\x1b[0m" if colour and hasattr(self.stream, "rich_proxied_file") else text
