"""``gcs film``: a film of a run."""

import argparse
import re
from functools import partial
from pathlib import Path

from gcs.app.arguments import number, whole_number
from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing

DESCRIPTION = """\
Makes a film of a run from the scene of its report page, without a display or a graphics card, and prints its path:
film.mp4 in the run folder, or --out FILE, whose suffix says the format: .mp4, .webp or .gif. Needs Chromium or Chrome,
and pip install 'cooplift[film]'.
"""

VIEWS = ("around", "overview", "follow", "top")


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d+)x(\d+)", text)
    size = (int(found[1]), int(found[2])) if found else (0, 0)
    if any(length % 2 or not 160 <= length <= 4096 for length in size):
        raise argparse.ArgumentTypeError(f"{text!r} is not WIDTHxHEIGHT, even numbers from 160 to 4096")
    return size


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("run_dir", type=Path, metavar="RUN_DIR", help="a run folder")
    add("--out", type=Path, metavar="FILE", help="the film (default: film.mp4 in the run folder)")
    add("--from", type=float, metavar="S", dest="start", help="begin at this time of the flight (s)")
    add("--to", type=float, metavar="S", dest="end", help="end at this time of the flight (s)")
    add("--speed", type=partial(number, least=0.01, most=100.0), default=1.0, metavar="X",
        help="seconds of the flight in one of the film (default: 1)")  # fmt: skip
    add("--size", type=_size, default=(960, 540), metavar="WxH", help="pixels (default: 960x540)")
    add("--fps", type=partial(whole_number, least=1, most=60), default=20, metavar="N",
        help="frames in a second of the film (default: 20)")  # fmt: skip
    add("--camera", choices=VIEWS, default=VIEWS[0],
        help="around: from beside the flight, slowly to and fro, of a wide one what is near the payload (default); "
        "overview, follow and top: those of the report page")  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    with importing():
        from gcs.record.run_data import read_run
        from gcs.view.film import FilmSettings, write_film

    a = arguments
    settings = FilmSettings(a.start, a.end, a.speed, a.size, a.fps, a.camera)
    print(write_film(read_run(a.run_dir), settings, a.out))
    return ExitStatus.DONE
