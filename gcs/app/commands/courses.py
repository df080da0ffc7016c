"""``gcs courses``: campaigns of obstacle scenarios, random ones and other people's."""

import argparse
import dataclasses
from functools import partial
from pathlib import Path
from typing import Any

from gcs.app.arguments import CONTROLLERS, SettingsGrid, number, time_span, whole_number
from gcs.app.campaigns import add_campaign_arguments, run_campaign
from gcs.app.exit_status import ExitStatus
from gcs.campaign.folder import adopt_folder, plain
from gcs.campaign.grid import check_grid
from gcs.campaign.scenarios.generator import DEFAULT_KINDS, KINDS
from gcs.campaign.scenarios.plans import Scenarios
from gcs.campaign.suites.plans import Suite, read_suite
from gcs.config import read_system
from gcs.errors import UnusableInput

DESCRIPTION = """\
Flies many obstacle scenarios in parallel and shows the distribution of clearance, tilt and delay.

  gcs courses                                200 scenarios of seed 1 on all cores
  gcs courses --count 20 --kinds moving      obstacles on a collision course with the payload
  gcs courses --count 60 --kinds forest rooms    obstacles with passages, some of them too narrow
  gcs courses --count 1000 --out runs/courses-seed1    adds more scenarios to a campaign
  gcs courses --level both --budget 30m      all by planning alone, those that nearly fail in full
  gcs courses --suite tests/*.yaml           tests of Aerialist; also lists in JSON lines, and missions
  gcs courses --suite figure_eight_spheres --set avoidance.margin=0.25,0.5,1.0    with each of these settings

Every scenario is a mission file that `gcs fly` repeats. A campaign that was interrupted resumes when started again.
A scenario is passed without contact, with 0.3 m of clearance, payload angles up to 6 deg, arrival at the goal, and the
UAV separation that follows from the system file (0.75 m by default). Where the standing obstacles leave no way for the
formation, it is passed if the flight is broken off and its reason names the narrowest gap, within 0.3 m. Exit status:
0 all passed; 1 not all; 2 unusable input; 3 results cannot be written; 130 interrupted, results kept.
"""

COUNT, FASTEST, SPEED = 200, 2.0, 2.5
LEVELS = ("planning", "full", "both")
_, FULL, BOTH = LEVELS


def add_arguments(parser: argparse.ArgumentParser) -> None:
    add = parser.add_argument
    add("--count", type=partial(whole_number, least=1, most=9999), metavar="N",
        help=f"number of random scenarios (default: {COUNT})")  # fmt: skip
    add("--seed", type=partial(whole_number, least=0, most=2**63 - 1), default=1, metavar="S",
        help="seed of the scenarios, of a suite that of its noise (default: 1)")  # fmt: skip
    add("--kinds", nargs="+", choices=KINDS, metavar="KIND",
        help=f"kinds of random scenarios, taken in turn: {', '.join(KINDS)} (default: the first five)")  # fmt: skip
    add("--suite", nargs="+", type=Path, metavar="FILE",
        help="in place of random scenarios: tests of Aerialist (.yaml) with their plans, lists of poles and boxes in "
        "JSON lines (.jsonl), missions")  # fmt: skip
    add("--speed", type=partial(number, least=0.1, most=20.0), metavar="V",
        help=f"speed of a suite's missions that do not say, in m/s (default: {SPEED:g})")  # fmt: skip
    add("--controller", choices=CONTROLLERS, default="idc", help="as for gcs fly (default: idc)")
    add("--config", type=Path, metavar="C", help="system file in place of the default system")
    add("--set", action=SettingsGrid, dest="grid", default={}, metavar="PATH=A,B,C",
        help="fly each scenario with each of these settings in place of the system file's, such as "
        "avoidance.margin=0.4,0.5; if repeated, with every combination")  # fmt: skip
    add("--obstacle-speed", type=partial(number, least=0.5, most=20.0), metavar="V",
        help=f"highest speed of moving obstacles in m/s, but of stop_and_go (default: {FASTEST:g})")  # fmt: skip
    add("--level", choices=LEVELS, default=FULL, help="planning: perception, guidance and safety filter on ideal "
        "tracking, without physics and MAVLink; full: whole flights; both: planning, then whole flights, those of the "
        "least planned clearance first (default: full)")  # fmt: skip
    add("--budget", type=time_span, metavar="TIME",
        help="of --level both: CPU time after which no further flight is flown in full, such as 30m, 2h (default: all)"
        )  # fmt: skip
    add_campaign_arguments(parser, "runs/courses-seed<S>, runs/courses-<first file of the suite>")


def run(arguments: argparse.Namespace) -> int:
    if arguments.level != FULL and arguments.controller != "idc":
        raise UnusableInput(f"--level {arguments.level}: the controller {arguments.controller} plans nothing")
    if arguments.level != BOTH and arguments.budget is not None:
        raise UnusableInput("--budget goes with --level both")
    check_grid(read_system(arguments.config), arguments.grid)  # refused before the campaign begins
    generator, name = _suite(arguments) if arguments.suite else _random(arguments)
    return _run_level(generator, arguments.out or Path("runs") / f"courses-{name}", arguments)


def _random(arguments: argparse.Namespace) -> tuple[Scenarios, str]:
    """Return random scenarios, and their name."""
    if arguments.speed is not None:
        raise UnusableInput("--speed goes with --suite: random scenarios have their own speeds")
    scenarios = Scenarios(
        **_common(arguments),
        count=arguments.count or COUNT,
        kinds=tuple(arguments.kinds or DEFAULT_KINDS),
        fastest=arguments.obstacle_speed or FASTEST,
    )
    return scenarios, f"seed{arguments.seed}"


def _suite(arguments: argparse.Namespace) -> tuple[Suite, str]:
    """Return other people's scenarios, read whole, and their name."""
    for option in ("count", "kinds", "obstacle_speed"):
        if getattr(arguments, option) is not None:
            raise UnusableInput(f"--{option.replace('_', '-')} is for random scenarios, not for --suite")
    speed = arguments.speed or SPEED
    courses = read_suite(arguments.suite, arguments.config, speed, arguments.seed)
    return Suite(**_common(arguments), courses=tuple(courses), speed=speed), plain(arguments.suite[0].stem)


def _common(arguments: argparse.Namespace) -> dict[str, Any]:
    return {name: getattr(arguments, name) for name in ("seed", "controller", "config", "grid")}


def _run_level(generator: Scenarios | Suite, out: Path, arguments: argparse.Namespace) -> ExitStatus:
    """Fly on ``arguments.level``, and print the report. The planning level has a folder of its own in ``out``."""
    if arguments.level == FULL:
        return run_campaign(generator, out, arguments)
    planning = dataclasses.replace(generator, planning=True)
    if arguments.level == BOTH:
        return run_campaign(generator, out, arguments, planning)
    adopt_folder(out, generator.settings)
    return run_campaign(planning, out / "planning", arguments)
