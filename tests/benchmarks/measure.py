"""What `make benchmark` and `make benchmark-check` measure: flights of one tree, and the anchor, on one core."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
FLIGHTS = ("figure_eight", "two_spheres", "obstacles_200")
_CORRIDOR = 2.6  # m between the curve and the nearest obstacle


def use_one_core():
    """Keep this process, and all that it starts, on one core."""
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})


def fly(tree, mission, *options):
    """Return what `flight_cost.py` prints of a flight of the program in ``tree``."""
    return _json([sys.executable, HERE / "flight_cost.py", mission, *options], tree)


def anchor(seconds=10.0):
    """Return what `anchor.py` prints; ANCHOR_PYTHON names a Python with gym-pybullet-drones."""
    return _json([os.environ.get("ANCHOR_PYTHON") or sys.executable, HERE / "anchor.py", "--seconds", seconds], None)


def _json(command, tree):
    threads = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    environment = {**os.environ, **threads, "PYTHONPATH": str(tree)} if tree else {**os.environ, **threads}
    done = subprocess.run(list(map(str, command)), env=environment, cwd=tree, capture_output=True, text=True)
    if done.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{done.stderr[-2000:]}")
    return json.loads(done.stdout.splitlines()[-1])


def write_missions(tree, folder, duration):
    """Write the missions of :data:`FLIGHTS` with the system file of ``tree``; return their paths by name."""
    figure = mission_text(tree, "figure_eight.toml", duration, altitude=3.0)
    texts = {
        "figure_eight": figure,
        "two_spheres": mission_text(tree, "figure_eight_spheres.toml", duration),
        "obstacles_200": figure + obstacles(200),
    }
    return {name: write(folder, name, text) for name, text in texts.items()}


def write(folder, name, text):
    """Write a mission; return its path."""
    path = Path(folder) / f"{name}.toml"
    path.write_text(text)
    return path


def mission_text(tree, name, duration, altitude=5.0):
    """Return a mission of the tree with another duration (s) and altitude (m), without its limits."""
    text = (Path(tree) / "missions" / name).read_text().split("\n[limits]")[0]
    system = json.dumps(str(Path(tree) / "missions" / "system.toml"))
    text = text.replace("altitude = 5.0", f"altitude = {altitude}")
    return text.replace('"system.toml"', system).replace("duration = 40.0", f"duration = {duration}")


def obstacles(count):
    """Return ``count`` standing spheres and poles on the map, about the figure eight at 3 m and clear of it."""
    rng = np.random.default_rng(1)
    angle = np.linspace(0.0, 2.0 * np.pi, 400)
    curve = np.column_stack([6.0 * np.sin(angle), -3.0 * np.sin(2.0 * angle)])
    tables = []
    while len(tables) < count:
        north, east, radius = rng.uniform(-14.0, 14.0), rng.uniform(-11.0, 11.0), rng.uniform(0.2, 0.5)
        if np.linalg.norm(curve - [north, east], axis=1).min() - radius < _CORRIDOR:
            continue
        name = f"obstacle {len(tables) + 1}"
        if len(tables) % 2:
            kind = f'shape = "pole"\nposition = [{north:.2f}, {east:.2f}]\nheight = 8.0'
        else:
            kind = f'shape = "sphere"\nposition = [{north:.2f}, {east:.2f}, {-rng.uniform(1.5, 5.5):.2f}]'
        tables.append(f'\n[[obstacle]]\nname = "{name}"\n{kind}\nradius = {radius:.2f}\nknown = true\n')
    return "".join(tables)
