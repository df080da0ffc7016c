"""``gcs film``: a film of a run."""

import argparse
import re
from pathlib import Path

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

DESCRIPTION = """\
Makes a film of a run from the scene of its report page, without a display or a graphics card, and prints its path:
film.mp4 in the run folder, or --out FILE, whose suffix says the format: .mp4, .webp or .gif. Needs Chromium or Chrome,
and pip install 'cooplift[film]'.
"""


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d{1,5})x(\d{1,5})", text)
    if found is None:
        raise argparse.ArgumentTypeError(f"{text!r} is not WIDTHxHEIGHT, such as 1280x720")
    return int(found[1]), int(found[2])


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    parser.add_argument("run_dir", type=Path, metavar="RUN_DIR", help="a run folder")
    parser.add_argument("--out", type=Path, metavar="FILE", help="the film (default: film.mp4 in the run folder)")
    parser.add_argument("--from", type=float, metavar="S", dest="start", help="begin at this time of the flight (s)")
    parser.add_argument("--to", type=float, metavar="S", dest="end", help="end at this time of the flight (s)")
    parser.add_argument(
        "--speed", type=float, default=1.0, metavar="X", help="seconds of the flight in one of the film"
    )
    parser.add_argument("--size", type=_size, default=(1280, 720), metavar="WxH", help="pixels (default: 1280x720)")
    parser.add_argument("--fps", type=int, default=25, metavar="N", help="frames in a second (default: 25)")
    parser.add_argument("--camera", choices=("follow", "overview", "top"), help="default: that of the report page")


def run(arguments: argparse.Namespace) -> int:
    """Run the command, and return its exit status."""
    with importing():
        from gcs.record.run_data import read_run
        from gcs.view.film import FilmSettings, write_film

    a = arguments
    settings = FilmSettings(a.start, a.end, a.speed, a.size, a.fps, a.camera)
    print(write_film(read_run(a.run_dir), settings, a.out))
    return ExitStatus.DONE
