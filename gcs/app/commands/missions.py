"""``gcs missions``: what comes with the package."""

import argparse

from gcs.app.exit_status import ExitStatus
from gcs.mission.own import description, own_files

DESCRIPTION = """\
Lists the missions and campaigns that come with the package; `gcs fly`, `gcs check`, `vehicle-sim --mission` and
`gcs.fly` take a mission by its name, `gcs faults` a campaign.
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    pass


def run(arguments: argparse.Namespace) -> int:
    for table, title in (("mission", "missions, gcs fly NAME:"), ("campaign", "campaigns of faults, gcs faults NAME:")):
        print(title)
        for name, path in own_files(table).items():
            print(f"  {name:<21} {description(path)}")
    return ExitStatus.DONE
