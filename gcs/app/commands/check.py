"""``gcs check``: what a mission file says."""

from __future__ import annotations

import argparse
import dataclasses
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gcs.app.arguments import add_system_arguments
from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing
from gcs.errors import UnusableInput

if TYPE_CHECKING:
    from gcs.mission.model import Mission

DESCRIPTION = "Reads a mission and says what will be flown, or every reason why not, with file and line."


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("mission", type=Path, metavar="MISSION", help="mission file, or a name of gcs missions")
    add_system_arguments(parser)
    parser.add_argument("--json", action="store_true", help="print legs, notes and reasons as JSON")
    parser.add_argument("--plot", type=Path, metavar="FILE", help="draw the map of the mission, too: .png, .svg, .pdf")


def run(arguments: argparse.Namespace) -> int:
    with importing():
        from rich.console import Console

        from gcs.app.fly_options import read_mission_for
        from gcs.flight.feasibility import preflight
        from gcs.mission.describe import describe

    try:
        mission = read_mission_for(arguments.mission, arguments.config, arguments.vehicles, arguments.settings)
        found = preflight(mission)
    except UnusableInput as refused:
        if arguments.json:
            print(json.dumps({"mission": str(arguments.mission), "accepted": False, "reasons": refused.reasons}))
        raise
    mission = dataclasses.replace(mission, notes=(*mission.notes, *found.lines))
    if arguments.plot is not None:
        with importing():
            from gcs.view.mission_map import write_map

        write_map(mission, arguments.plot)
    if arguments.json:
        print(json.dumps(_document(mission), indent=2))
    else:
        Console(highlight=False).print(describe(mission))
    return ExitStatus.DONE


def _document(mission: Mission) -> dict[str, Any]:
    """Return what is flown, for programs."""
    from gcs.mission.flown_legs import flown_legs
    from gcs.mission.model import Lissajous

    document = {
        "mission": str(mission.path), "accepted": True, "reasons": [], "name": mission.name,
        "vehicles": mission.system.team.vehicles, "seed": mission.seed, "home": dataclasses.asdict(mission.home),
        "notes": list(mission.notes),
    }  # fmt: skip
    if isinstance(mission.reference, Lissajous):
        return {**document, "curve": dataclasses.asdict(mission.reference)}
    flight = flown_legs(mission.reference, mission.system)
    legs = [dataclasses.asdict(leg) for leg in flight.legs]
    return {**document, "legs": legs, "end": flight.end, "length_m": flight.length, "time_s": flight.time}
