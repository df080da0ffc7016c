"""The command ``vehicle-sim``."""

import signal
import sys

from gcs.app.imports import importing
from gcs.app.logs import logging_to
from gcs.app.output import output_that_may_end
from gcs.drivers.interrupt import Interrupt
from gcs.errors import GcsError, UnusableInput
from gcs.numerics import choose_kernels
from idc_controller.errors import IdcError
from vehicle_sim.app.arguments import parse
from vehicle_sim.app.ending import INTERRUPTED
from vehicle_sim.world.engine_messages import greeting_of_engine_dropped
from vehicle_sim.world.errors import SimulationError

UNUSABLE_INPUT = 2


def main(argv: list[str] | None = None) -> int:
    """Run the command; ``argv`` without the program's name. Returns the exit status."""
    with output_that_may_end("stderr"):
        return _main(sys.argv[1:] if argv is None else argv)


def _main(arguments: list[str]) -> int:
    if arguments[:1] == ["impair"]:
        return _impair(arguments[1:])
    choose_kernels()
    try:
        options = parse(arguments)
    except UnusableInput as error:
        print(error, file=sys.stderr)
        return UNUSABLE_INPUT
    try:
        with Interrupt((signal.SIGINT,)):
            with importing(), greeting_of_engine_dropped():
                from vehicle_sim.app.launch import launch
            with logging_to(options):
                return launch(options, arguments)
    except (GcsError, SimulationError, IdcError) as error:
        print(f"vehicle-sim: {error}", file=sys.stderr)
        return UNUSABLE_INPUT
    except KeyboardInterrupt:  # while starting; later it is a request to end
        return INTERRUPTED


def _impair(arguments: list[str]) -> int:
    """Run ``vehicle-sim impair``, which needs neither the world nor its kernels."""
    from vehicle_sim.app.impair import impair
    from vehicle_sim.app.impair_arguments import parse_impair

    try:
        with output_that_may_end("stdout"):
            return impair(parse_impair(arguments))
    except UnusableInput as error:
        print(error, file=sys.stderr)
    except SimulationError as error:
        print(f"vehicle-sim impair: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        return INTERRUPTED
    return UNUSABLE_INPUT
