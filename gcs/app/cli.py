"""The command ``gcs``: a table of its sub-commands, each a module of :mod:`gcs.app.commands`."""

import argparse
import os
import sys
from collections.abc import Sequence
from importlib import import_module

from rich_argparse import RawDescriptionRichHelpFormatter

from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing
from gcs.app.logs import LOG, add_log_arguments, logging_to
from gcs.errors import GcsError, UnusableInput
from gcs.numerics import choose_kernels
from idc_controller.errors import IdcError

COMMANDS = {
    "fly": "fly a mission",
    "check": "say what will be flown, or why not",
    "report": "draw what happened in a run",
    "courses": "fly many random obstacle scenarios",
    "faults": "list the kinds of fault, fly campaigns of them",
    "study": "fly missions with one parameter changed",
    "reproduce": "regenerate the figures and numbers of the paper",
}
"""Each is a module with ``DESCRIPTION``, ``add_arguments(parser)`` and ``run(arguments)``, imported when named."""
_DESCRIPTION = """\
The ground station of cooplift: UAVs that carry one payload together.

  gcs check missions/delivery.plan          what will be flown, or every reason why not
  gcs fly missions/figure_eight.toml        flies it with a simulated swarm of its own
  gcs report runs/figure-eight-1            draws what happened
  gcs faults missions/telemetry_faults.toml flies a campaign of telemetry faults
  gcs courses                               flies 200 random obstacle scenarios and shows the distribution
  gcs study margin                          flies a mission with other margins; other studies likewise
  gcs reproduce --quick                     the paper's figures and numbers, as printed and as corrected
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command, and return its exit status."""
    words = sys.argv[1:] if argv is None else list(argv)
    choose_kernels()
    # pydantic would read the metadata of all that is installed.
    os.environ["PYDANTIC_DISABLE_PLUGINS"] = "__all__"
    arguments = _parser(words[0] if words else "").parse_args(words)
    with logging_to(arguments):
        try:
            return int(arguments.run(arguments))
        except UnusableInput as error:
            for reason in error.reasons:
                LOG.error(reason)
            return ExitStatus.UNUSABLE_INPUT
        except (GcsError, IdcError) as error:
            LOG.error("gcs: %s", error)
            return ExitStatus.OUTSIDE_LIMITS
        except KeyboardInterrupt:
            return ExitStatus.INTERRUPTED


def _parser(command: str) -> argparse.ArgumentParser:
    """Return the parser, with the arguments of ``command`` only: the modules of the others are not imported."""
    style = RawDescriptionRichHelpFormatter
    parser = argparse.ArgumentParser(prog="gcs", description=_DESCRIPTION, formatter_class=style)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, summary in COMMANDS.items():
        if name != command:
            commands.add_parser(name, help=summary)
            continue
        with importing():
            module = import_module(f"gcs.app.commands.{name}")
        chosen = commands.add_parser(name, help=summary, description=module.DESCRIPTION, formatter_class=style)
        module.add_arguments(chosen)
        add_log_arguments(chosen)
        chosen.set_defaults(run=module.run)
    return parser


if __name__ == "__main__":
    sys.exit(main())
