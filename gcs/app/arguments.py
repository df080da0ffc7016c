"""Types of command-line arguments that several commands of both programs have."""

import argparse
import math

CONTROLLERS = ("idc", "mpc", "paper")


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
