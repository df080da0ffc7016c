"""``gcs courses``: campaigns of random obstacle scenarios."""

import argparse
from functools import partial
from pathlib import Path

from gcs.app.arguments import CONTROLLERS, number, whole_number
from gcs.app.campaigns import add_campaign_arguments, run_campaign
from gcs.campaign.scenarios.generator import DEFAULT_KINDS, KINDS
from gcs.campaign.scenarios.plans import Scenarios

DESCRIPTION = """\
Flies many random obstacle scenarios in parallel and shows the distribution of clearance, tilt and delay.

  gcs courses                                200 scenarios of seed 1 on all cores
  gcs courses --count 20 --kinds moving      obstacles on a collision course with the payload
  gcs courses --count 1000 --out runs/courses-seed1    adds more scenarios to a campaign

Every scenario is a mission file that `gcs fly` repeats. A campaign that was interrupted resumes when started again.
A scenario is passed without contact, with 0.3 m of clearance, payload angles up to 6 deg, arrival at the goal, and the
UAV separation that follows from the system file (0.75 m by default). Exit status: 0 all passed; 1 not all; 2 unusable
input; 130 interrupted, results kept.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of the command."""
    add = parser.add_argument
    add("--count", type=partial(whole_number, least=1, most=9999), default=200, metavar="N",
        help="number of scenarios (default: 200)")  # fmt: skip
    add("--seed", type=partial(whole_number, least=0, most=2**63 - 1), default=1, metavar="S",
        help="seed of the scenarios (default: 1)")  # fmt: skip
    add("--kinds", nargs="+", choices=KINDS, default=list(DEFAULT_KINDS), metavar="KIND",
        help=f"kinds of scenarios, taken in turn: {', '.join(KINDS)} (default: the first five)")  # fmt: skip
    add("--controller", choices=CONTROLLERS, default="idc", help="as for gcs fly (default: idc)")
    add("--config", type=Path, metavar="C", help="system file in place of the default system")
    add("--obstacle-speed", type=partial(number, least=0.5, most=20.0), default=2.0, metavar="V",
        help="highest speed of moving obstacles in m/s (default: 2)")  # fmt: skip
    add_campaign_arguments(parser, "runs/courses-seed<S>")


def run(arguments: argparse.Namespace) -> int:
    """Run the command, and return its exit status."""
    scenarios = Scenarios(
        count=arguments.count,
        seed=arguments.seed,
        kinds=tuple(arguments.kinds),
        controller=arguments.controller,
        config=arguments.config,
        fastest=arguments.obstacle_speed,
    )
    return run_campaign(scenarios, arguments.out or Path("runs") / f"courses-seed{arguments.seed}", arguments)
