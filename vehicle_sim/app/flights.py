"""Flights of a campaign as forks of one process, which imports what both programs need once.

Reads from standard input, line by line, a folder and the arguments of ``gcs`` as a JSON array; carries out each in a
fork, in that folder, and then prints ``exit status N``. Ends with its standard input, as the flights do: they share it.
"""

import contextlib
import json
import os
import sys

from gcs.app.imports import importing
from gcs.numerics import choose_kernels
from vehicle_sim.world.engine_messages import greeting_of_engine_dropped

choose_kernels()
with importing(), greeting_of_engine_dropped():
    import gcs.app.cli
    import gcs.app.fly
    import gcs.app.progress
    import gcs.record.summary_table  # noqa: F401
    import vehicle_sim.app.cli
    import vehicle_sim.app.launch
    import vehicle_sim.faults.record  # noqa: F401
    from gcs.drivers.forked_program import FORK, run_program
    from gcs.record.run_folder import versions


def main() -> None:
    """Fly until the end of standard input."""
    versions()  # kept for the manifests
    stream = os.dup(sys.stdin.fileno())
    for line in sys.stdin:
        folder, *arguments = json.loads(line)
        flight = FORK.Process(target=_fly, args=(folder, arguments, stream))
        flight.start()
        flight.join()
        print(f"\nexit status {flight.exitcode}", flush=True)


def _fly(folder: str, arguments: list[str], stream: int) -> None:
    os.chdir(folder)
    run_program("gcs", arguments, (stream,))


if __name__ == "__main__":
    with contextlib.suppress(BrokenPipeError):  # the campaign has ended
        main()
