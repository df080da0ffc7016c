"""Obstacle scenarios on one level of evidence or on both (``gcs courses --level``)."""

import argparse
import dataclasses
from pathlib import Path

from rich.console import Group

from gcs.app.campaigns import campaign_console, executor_of, report, run_campaign
from gcs.app.exit_status import ExitStatus
from gcs.app.logs import LOG
from gcs.campaign.engine import Campaign
from gcs.campaign.folder import adopt_folder
from gcs.campaign.scenarios.levels import fly_levels, levels_report, undecided
from gcs.campaign.scenarios.plans import Scenarios
from gcs.campaign.suites.plans import Suite

PLANNING, FULL, BOTH = LEVELS = ("planning", "full", "both")


def run_level(generator: Scenarios | Suite, out: Path, arguments: argparse.Namespace) -> ExitStatus:
    """Fly on ``arguments.level``, and print the report. The planning level has a folder of its own in ``out``."""
    if arguments.level == FULL:
        return run_campaign(generator, out, arguments)
    on_planning, folder = dataclasses.replace(generator, planning=True), out / "planning"
    if arguments.level == PLANNING:
        adopt_folder(out, generator.settings)
        return run_campaign(on_planning, folder, arguments)
    console, interrupted = campaign_console(), False
    with executor_of(arguments) as executor:
        with console.status("writing the missions"):
            full = Campaign(generator, out, arguments.keep)
            planning = Campaign(on_planning, folder, arguments.keep)
        try:
            fly_levels(planning, full, arguments.budget, executor, console)
        except KeyboardInterrupt:
            interrupted = True
    planned, flown = planning.results, full.results
    reported = not flown or report(generator, flown, (), out, console)
    console.print(Group(*levels_report(planned, flown)))
    if interrupted:
        LOG.error("interrupted: start the command again to resume")
        return ExitStatus.INTERRUPTED
    if not reported:
        return ExitStatus.INCOMPLETE
    passed = all(result.passed for result in (*flown, *undecided(planned, flown)))
    return ExitStatus.DONE if passed else ExitStatus.OUTSIDE_LIMITS
