"""What the project has grown to: `make benchmark` adds it to the history.

python tests/benchmarks/growth.py [TREE]
"""

import ast
import json
import sys
import tempfile
from pathlib import Path

from measure import ROOT

PRODUCT = ("gcs", "idc_controller", "vehicle_sim")
FLOWN = "figure_eight_spheres"
BETWEEN = (20.0, 22.0)
"""Simulated s in which calls are counted: on the curve, both spheres on the map."""


def size(tree):
    """Return lines of product and tests, modules, settings and public names of a tree, by reading its files."""
    product = [path for package in PRODUCT for path in (tree / package).rglob("*.py")]
    settings = (tree / "docs" / "settings.md").read_text(encoding="utf-8").splitlines()
    return {
        "product_lines": sum(map(lines, product)),
        "test_lines": sum(map(lines, (tree / "tests").rglob("*.py"))),
        "modules": len(product),
        "settings": sum(line.startswith("| `") for line in settings),
        "public_names": len(public_names(tree / "gcs" / "__init__.py")),
    }


def lines(path):
    return len(path.read_text(encoding="utf-8").splitlines())


def public_names(path):
    """Return the names that ``__all__`` of a module lists; none without it."""
    for node in ast.parse(path.read_text(encoding="utf-8")).body:
        if isinstance(node, ast.Assign) and [getattr(target, "id", "") for target in node.targets] == ["__all__"]:
            return ast.literal_eval(node.value)
    return []


def calls_of_a_control_step(mission=FLOWN, begin=BETWEEN[0], end=BETWEEN[1]):
    """Return the function calls (of Python and of C) that the ground makes in a control period: the mean.

    The same in each process, whatever the machine.
    """
    from gcs.app.in_process import FlightInProcess
    from gcs.mission.read import read_mission

    read = read_mission(ROOT / "missions" / f"{mission}.toml")
    calls = 0

    def count(frame, event, argument):
        nonlocal calls
        calls += event in ("call", "c_call")

    def counted(function):
        def call(*arguments):
            sys.setprofile(count)
            try:
                return function(*arguments)
            finally:
                sys.setprofile(None)

        return call

    with tempfile.TemporaryDirectory() as folder, FlightInProcess(read, Path(folder)) as flight:
        flight.fly(until=begin)
        station = flight.station
        station.receive_all = counted(station.receive_all)
        station.datagrams_to_send = counted(station.datagrams_to_send)
        flight.fly(until=end)
    return round(calls / ((end - begin) * read.system.rates.control))


if __name__ == "__main__":
    if len(sys.argv) > 1:
        print(json.dumps(size(Path(sys.argv[1]))))
    else:
        print(json.dumps({**size(ROOT), "step_calls": calls_of_a_control_step()}))
