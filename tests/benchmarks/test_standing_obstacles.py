"""The control step among many standing obstacles: a whole flight through 0 to 200 of them, and one that is unknown.

    python tests/benchmarks/test_standing_obstacles.py              a table against the number of obstacles
    python tests/benchmarks/test_standing_obstacles.py 200 --wall   one flight that also needs a detour

Figures are CPU times of the ground (ms), from the first datagram of a control period to the last byte out.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from threadpoolctl import threadpool_limits

sys.path.insert(0, str(Path(__file__).parents[2]))
sys.path.insert(0, str(Path(__file__).parents[1]))

from flights import LONGEST, MISSIONS, InProcessFlight

from gcs.flight.compute_times import Part
from gcs.mission.read import read_mission

LENGTH = 30.0  # m, of the flight
COUNTS = (0, 50, 100, 200)

MISSION = f"""
[mission]
name = "standing obstacles"
system = "{MISSIONS / "system.toml"}"
seed = 1

[reference]
kind = "waypoints"
points = [[{LENGTH}, 0.0, -4.0]]
speed = 1.5
return_home = false

[[obstacle]]
name = "unknown"
shape = "sphere"
position = [8.0, 0.3, -4.0]
radius = 0.5
known = false
"""
SPHERE = """
[[obstacle]]
name = "sphere {number}"
shape = "sphere"
position = [{north:.3f}, {east:.3f}, {down:.3f}]
radius = 0.5
known = true
"""
POLE = """
[[obstacle]]
name = "pole {number}"
shape = "pole"
position = [{north:.3f}, {east:.3f}]
radius = 0.2
height = 9.0
known = true
"""
WALL = """
[[obstacle]]
name = "wall"
shape = "wall"
position = [20.0, 0.0, -4.5]
size = [0.3, 8.0, 9.0]
known = true
"""


def mission_text(count, *, wall=False, seed=1):
    """A mission with ``count`` poles and spheres on the map on both sides of its path, as dense for any ``count``."""
    rng, texts = np.random.default_rng(seed), [MISSION, WALL * wall]
    places = [(float(north), float(east)) for north, east in rng.uniform((-5.0, 2.5), (LENGTH + 5.0, 30.0), (count, 2))]
    # The nearest first: fewer of them are fewer far away.
    for number, (north, east) in enumerate(sorted(places, key=lambda place: place[1])):
        side, text = (1.0, -1.0)[number % 2], (POLE, SPHERE)[number // 2 % 2]
        texts.append(text.format(number=number, north=north, east=side * east, down=float(rng.uniform(-8.0, -1.0))))
    return "".join(texts)


class StandingObstacleFlight:
    """One flight, and the CPU time (ms) of each part of its control steps, (steps, parts)."""

    def __init__(self, text, until):
        parts = []
        with tempfile.TemporaryDirectory() as folder, threadpool_limits(1):
            path = Path(folder) / "mission.toml"
            path.write_text(text)
            mission = read_mission(path)
            with InProcessFlight(mission, Path(folder) / "run", obstacles=mission.obstacles) as flight:
                control, record = flight.station.flight.control, flight.recorder.compute_times
                control.compute_times._stopwatch = control.controller._stopwatch = time.process_time

                def keep(at, decision, spent):
                    parts.append(spent)
                    record(at, decision, spent)

                flight.recorder.compute_times = keep
                begin = time.process_time()
                flight.fly(until=until)
                self.cpu = 1e3 * (time.process_time() - begin) / flight.now
                """CPU time of ground and world for a simulated second (ms)."""
                guidance = flight.flight.system.guidance
                self.outcome = f"{flight.flight.phase.name} at {flight.now:.0f} s, {guidance.detours} detours"
        self.parts = 1e3 * np.array(parts)

    @property
    def steps(self):
        """All parts together (steps,)."""
        return self.parts.sum(axis=1)


def show(counts, wall, until):
    print(f"{'obstacles':>9} | {'ms/s':>6} | step: {'p50':>6} {'p99':>6} {'max':>6} | p99 of the parts")
    for count in counts:
        flight = StandingObstacleFlight(mission_text(count, wall=wall), until)
        p50, p99 = np.percentile(flight.steps, (50, 99))
        of_parts = zip(Part, np.percentile(flight.parts, 99, axis=0), strict=True)
        print(
            f"{count:>9} | {flight.cpu:6.0f} | {'':5} {p50:6.2f} {p99:6.2f} {flight.steps.max():6.1f} | "
            f"{flight.outcome} | " + ", ".join(f"{part.name.lower()} {value:.1f}" for part, value in of_parts)
        )


def test_standing_obstacles_benchmark():
    main(["0", "200", "--until", "16"])


def main(arguments=None):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("counts", nargs="*", type=int, default=COUNTS)
    parser.add_argument("--wall", action="store_true", help="a wall across the path")
    parser.add_argument("--until", type=float, default=LONGEST, help="s of the flight, at most")
    chosen = parser.parse_args(arguments)
    show(chosen.counts, chosen.wall, chosen.until)


if __name__ == "__main__":
    main()
