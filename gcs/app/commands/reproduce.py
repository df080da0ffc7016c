"""``gcs reproduce``: its arguments, and the folder that it fills."""

from __future__ import annotations

import argparse
import csv
import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from gcs.app.arguments import number_of_jobs
from gcs.app.exit_status import ExitStatus
from gcs.errors import UnusableInput, UnwritableRecord
from gcs.mission.own import own_folder
from gcs.mission.read import read_mission
from gcs.record.run_data import read_run
from gcs.record.run_folder import UnwritableFile, check_writable, make_folder
from gcs.reproduce import figures, work
from gcs.reproduce.numbers import matrices, numbers
from gcs.reproduce.page import paper_text, rounded, write_page
from gcs.reproduce.plan import Plan, plan
from gcs.reproduce.work import Results

DESCRIPTION = """\
Regenerates the figures and numbers of the paper into one folder: as printed, as corrected, and with this project's
controller on the same plant. Read DIR/index.html first.

  gcs reproduce --quick                     within a minute: shorter simulations, no flights in PyBullet
  gcs reproduce --out reproduction          everything, within 15 minutes on two cores

numbers.json has every number that docs/paper.md quotes, matrices/ the matrices A and B as CSV. That a claim of the
paper does not reproduce is a result, not a failure. Exit status: 0 done; 2 unusable input; 3 DIR cannot
be written any more; 130 interrupted.
"""
COMPARED = ("printed", "corrected", "project")
SHOWN = ("printed", "project")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("--quick", action="store_true", help="within a minute: shorter, without the flights")
    parser.add_argument(
        "--out", type=Path, default=Path("reproduction"), metavar="DIR",
        help="made if absent, refused if not empty (default: reproduction)",
    )  # fmt: skip
    parser.add_argument(
        "--jobs", type=number_of_jobs, default=None, metavar="J", help="at a time (default: auto, the cores)"
    )
    parser.add_argument(
        "--missions", type=Path, metavar="DIR",
        help="folder of the mission files that are flown (default: the package's own)",
    )  # fmt: skip


def run(arguments: argparse.Namespace) -> int:
    if arguments.quick and arguments.missions is not None:
        raise UnusableInput("gcs reproduce: --quick flies no missions: leave --missions out")
    chosen, out, missions = plan(arguments.quick), arguments.out, arguments.missions or own_folder()
    # All that can be wrong is looked for before anything is written.
    for mission, _ in chosen.flights.values():
        read_mission(missions / mission)
    check_writable(out)
    if out.exists() and any(out.iterdir()):
        raise UnusableInput(f"{out}: the folder is not empty: name another with --out")
    make_folder(out)
    console = Console(highlight=False, soft_wrap=True)
    begin = time.monotonic()
    try:
        with _progress(console, chosen) as done:
            results = work.run(chosen, missions, out, arguments.jobs, done)
            found = rounded(numbers(chosen, results))
            numbers_text = json.dumps(found, indent=1, allow_nan=False) + "\n"
            (out / "numbers.json").write_text(numbers_text, encoding="utf-8")
            (out / "paper.md").write_text(paper_text(found, links=False), encoding="utf-8")
            _write_matrices(out / "matrices")
            done("numbers and matrices")
            pictures = _draw(chosen, results, found, out, done)
    except KeyboardInterrupt:
        Console(stderr=True, highlight=False).print(f"interrupted: {out} is not complete")
        return ExitStatus.INTERRUPTED
    except UnwritableFile as error:
        raise UnwritableRecord(str(error)) from None
    except OSError as error:
        raise UnwritableRecord(f"{error.filename or out}: cannot be written: {error.strerror}") from None
    page = write_page(out, found, pictures, time.monotonic() - begin)
    console.print(_overview(found), markup=False)
    console.print(f"Results   {page}", markup=False)
    return ExitStatus.DONE


def _write_matrices(folder: Path) -> None:
    folder.mkdir()
    for name, (matrix, rows, columns) in matrices().items():
        with (folder / f"{name}.csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file)
            writer.writerow(["", *columns])
            writer.writerows([row, *values] for row, values in zip(rows, matrix.tolist(), strict=True))


def _draw(chosen: Plan, results: Results, found: dict[str, Any], out: Path, done: Callable[[str], None]) -> list[str]:
    def simulations(section: str, names: tuple[str, ...]) -> dict[str, Any]:
        return {name: results.simulations[section, name] for name in names}

    without, spheres = "Without obstacles", "Two spheres, one of them moving"
    drawings: dict[str, Callable[[Path], None]] = {
        "trackxyz.png": lambda p: figures.draw_position(simulations("tracking", COMPARED), without, p),
        "attrpy.png": lambda p: figures.draw_attitude(simulations("tracking", COMPARED), without, p),
        "anim3d.png": lambda p: figures.draw_snapshot(simulations("tracking", SHOWN), without, p),
        "trackObsxyz.png": lambda p: figures.draw_position(simulations("avoidance", COMPARED), spheres, p),
        "attObsrpy.png": lambda p: figures.draw_attitude(simulations("avoidance", COMPARED), spheres, p),
        "animObs3d.png": lambda p: figures.draw_snapshot(simulations("avoidance", SHOWN), spheres, p),
        "sigmavsdev.png": lambda p: figures.draw_noise(found["noise_worst"], p),
        "mass.png": lambda p: figures.draw_mass(found["mass"], p),
        "margin.png": lambda p: figures.draw_margin(found["margin"], p),
        "anim3d.gif": lambda p: figures.animate(simulations("tracking", SHOWN), without, p, chosen.frames),
        "animObs3d.gif": lambda p: figures.animate(simulations("avoidance", SHOWN), spheres, p, chosen.frames),
    }
    poles = {name: folder for name, folder in results.folders.items() if name.startswith("pole_course")}
    if poles:
        runs = {name.removeprefix("pole_course_"): read_run(folder) for name, folder in poles.items()}
        drawings["gazObs.png"] = lambda p: figures.draw_course(runs, p)
        drawings["payloadObsGaz.png"] = lambda p: figures.draw_course_position(runs, p)
    for name, draw in drawings.items():
        draw(out / name)
        done(name)
    return list(drawings)


def _overview(found: dict[str, Any]) -> str:
    lines = []
    for section in ("tracking", "avoidance"):
        for name, n in found.get(section, {}).items():
            rmse = n["rmse_m"]["total"]
            values = f"RMSE {'-' if rmse is None else f'{rmse:.3f}'} m, roll {n['roll_max_deg']:.1f}, "
            values += f"pitch {n['pitch_max_deg']:.1f} deg"
            if "clearance_min_m" in n:
                values += f", clearance {n['clearance_min_m']:.2f} m"
            if n["lost_at_s"] is not None:
                values += f", lost at {n['lost_at_s']:.2f} s"
            lines.append(f"{section:<10} {name:<12} {values}")
    return "\n".join(lines)


@contextmanager
def _progress(console: Console, chosen: Plan) -> Iterator[Callable[[str], None]]:
    """Give what takes the name of each thing done: a bar at a terminal, elsewhere one line for each."""
    bar = Progress(
        TextColumn("reproduce"), BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[last]}"),
        TimeElapsedColumn(), console=console, transient=True, disable=not console.is_terminal,
    )  # fmt: skip
    drawings = 11 + (2 if chosen.flights else 0)
    task = bar.add_task("", total=len(chosen.cases) + len(chosen.flights) + 1 + drawings, last="")

    def done(name: str) -> None:
        bar.update(task, advance=1, last=name)
        if not console.is_terminal:
            console.print(name, markup=False)

    with bar:
        yield done
