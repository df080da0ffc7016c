"""The command ``gcs``: a table of its sub-commands, each a module of :mod:`gcs.app.commands`."""

import os
import sys
from argparse import Namespace
from collections.abc import Sequence
from importlib import import_module

from gcs.app.arguments import Parser, Version
from gcs.app.exit_status import ExitStatus
from gcs.app.imports import importing
from gcs.app.logs import LOG, add_log_arguments, logging_to
from gcs.app.output import output_that_may_end
from gcs.drivers.interrupt import Interrupt
from gcs.errors import GcsError, UnusableInput, UnwritableRecord
from gcs.numerics import choose_kernels
from idc_controller.errors import IdcError

COMMANDS = {
    "fly": "fly a mission",
    "serve": "present the team as one aircraft to any ground station",
    "check": "say what will be flown, or why not",
    "missions": "list the missions that come with the package",
    "report": "draw what happened in a run",
    "export": "write a run as ULog or as one telemetry log for each system",
    "film": "make a film of a run",
    "courses": "fly many random obstacle scenarios",
    "faults": "list the kinds of fault, fly campaigns of them",
    "reproduce": "regenerate the figures and numbers of the paper",
}
"""Each is a module with ``DESCRIPTION``, ``add_arguments(parser)`` and ``run(arguments)``, imported when named."""
_DESCRIPTION = """\
The ground station of cooplift: UAVs that carry one payload together.

  gcs missions                              the missions that come with the package
  gcs check delivery                        what will be flown, or every reason why not
  gcs fly figure_eight                      flies it with a simulated swarm of its own
  gcs serve --sim                           a team that QGroundControl, MAVSDK or MAVProxy flies as one aircraft
  gcs report runs/figure-eight-1            writes the page that shows what happened
  gcs export runs/figure-eight-1 --ulog     writes it as ULog files, one for each vehicle and one for the payload
  gcs film runs/figure-eight-1              makes a film of it
  gcs faults telemetry_faults               flies a campaign of telemetry faults
  gcs courses                               flies 200 random obstacle scenarios and shows the distribution
  gcs reproduce --quick                     the paper's figures and numbers, as printed and as corrected
"""


def main(argv: Sequence[str] | None = None) -> int:
    """Run the command, and return its exit status."""
    words = sys.argv[1:] if argv is None else list(argv)
    choose_kernels()
    # pydantic would read the metadata of all that is installed.
    os.environ["PYDANTIC_DISABLE_PLUGINS"] = "__all__"
    with output_that_may_end("stdout", "stderr"):
        return _main(words)


def _main(words: list[str]) -> int:
    try:
        with Interrupt():
            arguments = _parse(words)
            with logging_to(arguments):
                return _run(arguments)
    except UnusableInput as error:
        print(error, file=sys.stderr)
        return ExitStatus.UNUSABLE_INPUT
    except KeyboardInterrupt:
        return ExitStatus.INTERRUPTED


def _run(arguments: Namespace) -> int:
    """Run the command, its errors as lines of the log; return its exit status."""
    try:
        return int(arguments.run(arguments))
    except UnusableInput as error:
        for reason in error.reasons:
            LOG.error(reason)
        return ExitStatus.UNUSABLE_INPUT
    except UnwritableRecord as error:
        LOG.error(error)
        return ExitStatus.INCOMPLETE
    except (GcsError, IdcError) as error:
        LOG.error("gcs: %s", error)
        return ExitStatus.OUTSIDE_LIMITS


def _parse(words: list[str]) -> Namespace:
    """Return the arguments; those of the named command only are known: the modules of the others are not imported.

    Raises :class:`UnusableInput`.
    """
    command = next((word for word in words if word in COMMANDS), "")
    parser = chosen = Parser(prog="gcs", description=_DESCRIPTION)
    parser.add_argument("--version", action=Version)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    for name, summary in COMMANDS.items():
        if name != command:
            commands.add_parser(name, help=summary)
            continue
        with importing():
            module = import_module(f"gcs.app.commands.{name}")
        chosen = commands.add_parser(name, help=summary, description=module.DESCRIPTION)
        module.add_arguments(chosen)
        add_log_arguments(chosen)
        chosen.set_defaults(run=module.run)
    arguments, unknown = parser.parse_known_args(words)
    chosen.refuse_unknown(unknown)
    return arguments


if __name__ == "__main__":
    sys.exit(main())
