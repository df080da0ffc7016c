"""The command lines of both programs: their parser, and types of arguments that several commands have."""

import argparse
import math
import tomllib
from collections.abc import Sequence
from difflib import get_close_matches
from functools import partial
from importlib import metadata
from pathlib import Path
from typing import Any, NoReturn

from rich_argparse import RawDescriptionRichHelpFormatter

from gcs.errors import UnusableInput

CONTROLLERS = ("idc", "mpc", "paper")
_DISTRIBUTION = "cooplift"


class _Help(RawDescriptionRichHelpFormatter):
    """Texts are printed as they are: brackets name extras."""

    help_markup = text_markup = False


class Parser(argparse.ArgumentParser):
    """A parser that raises :class:`UnusableInput` of one line, without usage, and takes no abbreviated options."""

    def __init__(self, **keywords: Any) -> None:
        super().__init__(**{"allow_abbrev": False, "formatter_class": _Help, **keywords})

    def error(self, message: str) -> NoReturn:
        """Raise the error; ``--help`` prints the details."""
        raise UnusableInput(f"{self.prog}: {message}")

    def refuse_unknown(self, words: Sequence[str]) -> None:
        """Raise :class:`UnusableInput` if there are ``words`` that were not understood; names what they could mean."""
        if not words:
            return
        unknown = next((word.partition("=")[0] for word in words if word.startswith("-")), "")
        hint = ""
        if unknown in self._option_string_actions:
            hint = f": {unknown} goes behind the command"
        elif near := get_close_matches(unknown, self._option_string_actions, 1):
            hint = f": did you mean {near[0]}?"
        self.error(f"unrecognized arguments: {' '.join(words)}{hint}")


class Version(argparse.Action):
    """``--version``: print name and version, and exit."""

    def __init__(self, option_strings: Sequence[str], dest: str) -> None:
        super().__init__(option_strings, argparse.SUPPRESS, nargs=0, help="print name and version")

    def __call__(self, parser: argparse.ArgumentParser, *_: object) -> NoReturn:
        """Look the version up only now: the metadata are long."""
        try:
            version = metadata.version(_DISTRIBUTION)
        except metadata.PackageNotFoundError:
            version = "(not installed)"
        print(f"{parser.prog} {version} ({_DISTRIBUTION})")
        parser.exit()


def number_of_jobs(text: str) -> int | None:
    """Return the number of parallel flights; None: one per core."""
    return None if text == "auto" else whole_number(text, 1, 1000)


def whole_number(text: str, least: int, most: int) -> int:
    """Return an argument that is a whole number in a range."""
    try:
        value = int(text)
    except ValueError:
        value = least - 1
    if not least <= value <= most:
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number from {least} to {most}")
    return value


def number(text: str, least: float, most: float) -> float:
    """Return an argument that is a number in a range."""
    try:
        value = float(text)
    except ValueError:
        value = math.nan
    if not least <= value <= most:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number from {least:g} to {most:g}")
    return value


class Settings(argparse.Action):
    """``--set PATH=VALUE``, any number of times: settings by their path; a value is TOML's, else it is text."""

    def __call__(self, parser: argparse.ArgumentParser, namespace: argparse.Namespace, text: Any, *_: object) -> None:
        """Add a setting to those that were given before."""
        path, equals, value = text.partition("=")
        if not path or not equals:
            raise argparse.ArgumentError(self, f"{text!r} is not PATH=VALUE")
        setattr(namespace, self.dest, {**(getattr(namespace, self.dest) or {}), path: self.read(value)})

    def read(self, value: str) -> Any:
        """Return a value."""
        try:
            return tomllib.loads(f"value = {value}")["value"]
        except ValueError:
            return value


class SettingsGrid(Settings):
    """``--set PATH=A,B,C``: all values of each setting."""

    def read(self, value: str) -> list[Any]:
        """Return the values."""
        values = super().read(f"[{value}]")
        return values if isinstance(values, list) else value.split(",")


def add_settings(parser: argparse.ArgumentParser) -> None:
    """Add the option ``--set``; without it, ``settings`` is None."""
    parser.add_argument(
        "--set", action=Settings, dest="settings", metavar="PATH=VALUE",
        help="a setting in place of the system file's, such as avoidance.margin=0.4; may be repeated",
    )  # fmt: skip


def add_system_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options that change the system of a mission: ``--config``, ``--set`` and ``--vehicles``."""
    parser.add_argument("--config", type=Path, metavar="C", help="system file in place of the mission's")
    add_settings(parser)
    parser.add_argument(
        "--vehicles", type=VEHICLES, metavar="N", help="number of vehicles in place of the system file's"
    )


def time_span(text: str) -> float:
    """Return an argument that is a time (s), such as 90s, 30m or 2h."""
    if (unit := {"s": 1.0, "m": 60.0, "h": 3600.0}.get(text[-1:])) is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not a time such as 90s, 30m or 2h")
    return unit * number(text[:-1], 0.0, 1e6)


VEHICLES_MIN = 3
"""Fewer vehicles cannot hold a payload level."""
VEHICLES_MAX = 99
"""System id 100 is the payload unit's."""
VEHICLES = partial(whole_number, least=VEHICLES_MIN, most=VEHICLES_MAX)
"""Number of vehicles."""
SEED = partial(whole_number, least=0, most=2**63 - 1)
"""Seed of a generator of random numbers."""
SPEED = partial(number, least=0.001, most=1000.0)
"""Simulated seconds per second of wall time."""
