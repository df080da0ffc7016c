"""Fly short missions by the work tree's `gcs fly` and by that of another commit, and compare their records to the byte.

A refactoring that is meant to change no behaviour changes no byte:

  python tests/golden/golden.py                  with the commit before (HEAD~1)
  python tests/golden/golden.py --base main      with another commit
  python tests/golden/golden.py leg forest       these flights only
  python tests/golden/golden.py --renew          write the checksums anew, on purpose; no other commit is flown

Both fly on this machine. The checksums on file are compared as well where they hold: with the versions that they name,
and with the numeric code that the programs choose (`gcs/numerics.py`). Exit status 1 when a flight differs, with the
first row and column that do, and the largest differences. `telemetry.tlog` is compared without its time stamps, which
are those of the wall clock, twice: whole, and without the texts of its STATUSTEXT messages, so that a reworded message
can be distinguished from another flight.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import os
import platform
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from itertools import zip_longest
from pathlib import Path

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
sys.path.insert(0, str(HERE.parent / "support"))

from gcs.numerics import choose_kernels, differences  # noqa: E402

choose_kernels()  # before numpy is loaded: the checksums on file hold for that choice only

import numpy as np  # noqa: E402
import pymavlink.dialects.v20.common as mavlink  # noqa: E402
from commit_tree import environment_of, tree_of  # noqa: E402

from gcs.record.reader import read_table  # noqa: E402

CHECKSUMS = HERE / "checksums.json"
MISSIONS = HERE / "missions"
FILES = (
    "truth.csv", "forces.csv", "reference.csv", "estimate.csv", "innovations.csv", "plan.csv", "horizon.csv",
    "obstacles_estimate.csv", "obstacles_standing.csv", "telemetry.tlog",
)  # fmt: skip
ADDED = frozenset(("forces.csv", "innovations.csv", "horizon.csv"))
"""Files that earlier commits do not write: not compared then."""
PACKAGES = (
    "coal", "daqp", "filterpy", "numba", "numpy", "proxsuite", "pybullet", "pymavlink", "scipy", "shapely", "trimesh",
)  # fmt: skip
WITHOUT_TEXT = "telemetry.tlog without STATUSTEXT"
_STATUSTEXT = mavlink.MAVLINK_MSG_ID_STATUSTEXT
_STAMP_LENGTH = 8
FIRST_SECONDS = 5.0


@dataclass(frozen=True)
class Golden:
    """One flight: a mission file, tables appended to it, and a seed."""

    mission: Path
    tables: str = ""
    seed: int = 1


def fault(kind: str, keys: str) -> str:
    """Return the table of a fault in a mission file."""
    return f'\n[[fault]]\nkind = "{kind}"\n{keys}\n'


LEG = MISSIONS / "leg.toml"
GOLDEN = {
    "figure_eight": Golden(MISSIONS / "figure_eight.toml"),
    "spheres_1": Golden(MISSIONS / "spheres.toml", seed=1),
    "spheres_2": Golden(MISSIONS / "spheres.toml", seed=2),
    "poles": Golden(MISSIONS / "poles.toml"),
    "boxes": Golden(MISSIONS / "boxes.toml"),
    "forest": Golden(MISSIONS / "forest.toml"),
    "rooms": Golden(MISSIONS / "rooms.toml"),
    "overhang": Golden(MISSIONS / "overhang.toml"),
    "stop_and_go": Golden(MISSIONS / "stop_and_go.toml"),
    "mesh": Golden(MISSIONS / "mesh.toml"),
    "square": Golden(MISSIONS / "square.waypoints"),
    "delivery": Golden(ROOT / "missions" / "fenced_delivery.plan"),
    "leg": Golden(LEG),
    "fault_link": Golden(
        LEG, fault("packet_loss", "start = 0.0\nprobability = 0.1") + fault("jitter", "start = 4.0\nspread = 0.02")
    ),
    "fault_timing": Golden(LEG, fault("clock_step", "start = 6.0\nvehicles = [2]\nstep = 0.3")),
    "fault_values": Golden(
        LEG, fault("bias", 'start = 5.0\nvehicles = [2]\nchannel = "position"\namount = 0.5\naxes = ["x"]')
    ),
    "fault_sensors": Golden(LEG, fault("position_lost", "start = 6.0\nduration = 3.0\nvehicles = [1]")),
    "fault_world": Golden(LEG, fault("wind", "start = 2.0\nvelocity = [0.0, 2.0, 0.0]\ngust = 0.5")),
    "vehicle_lost": Golden(LEG, fault("partition", 'start = 7.0\nvehicles = [3]\ndirection = "telemetry"')),
    "sensing_lost": Golden(LEG, fault("obstacle_sensing_lost", "start = 6.0")),
}


def compare(name: str, base: Path | None) -> tuple[str, dict[str, str], list[str]]:
    """Return the name, the SHA-256 checksums by file, and the first differences from the flight of the tree ``base``.

    Args:
        name: of :data:`GOLDEN`.
        base: folder of the other commit; None: there is none.
    """
    with tempfile.TemporaryDirectory() as scratch:
        folder = fly(name, ROOT, Path(scratch) / "now")
        if isinstance(folder, str):
            return name, {}, [folder]
        found = checksums(folder)
        if base is None:
            return name, found, []
        earlier = fly(name, base, Path(scratch) / "before")
        if isinstance(earlier, str):
            return name, found, [earlier]
        texts = {file: first_difference(earlier / file, folder / file) for file in FILES}
        differing = [text for text in texts.values() if text]
        for file, text in texts.items():
            if file.endswith(".csv") and " row" in text:  # both are there, with the same columns
                differing.append(f"{file}: {largest_difference(earlier / file, folder / file)}")
        return name, found, differing


def fly(name: str, tree: Path, scratch: Path) -> Path | str:
    """Fly a mission by the `gcs fly` of a tree; return the run folder, or what it printed where it flew nothing."""
    golden = GOLDEN[name]
    scratch.mkdir()
    mission = scratch / golden.mission.name
    system = json.dumps(str(tree / "missions" / "system.toml"))
    text = golden.mission.read_text(encoding="utf-8").replace('"../../../missions/system.toml"', system)
    rock = json.dumps(str(ROOT / "missions" / "rock.stl"))
    mission.write_text(text.replace('"../../../missions/rock.stl"', rock) + golden.tables, encoding="utf-8")
    command = [sys.executable, "-m", "gcs", "fly", mission, "--seed", golden.seed, "--run-dir", scratch / "run"]
    done = subprocess.run(
        [*map(str, command), "--no-pictures"], cwd=tree, env=environment_of(tree), capture_output=True, text=True
    )
    if not (scratch / "run" / "truth.csv").exists():
        return f"{'work tree' if tree == ROOT else 'base'}: nothing flown: {done.stderr.strip()[-500:]}"
    return scratch / "run"


def first_difference(earlier: Path, later: Path) -> str:
    """Return the first row and column in which two records differ, with both values; empty where they are equal."""
    if later.name in ADDED and later.exists() and not earlier.exists():
        return ""
    if not (earlier.exists() and later.exists()):
        return "" if earlier.exists() == later.exists() else f"{later.name}: in one of the two only"
    is_table = later.suffix == ".csv"
    old, new = (_rows(path.read_bytes(), is_table) for path in (earlier, later))
    if is_table and old and new and new[0].startswith(old[0] + b","):  # columns were added on the right
        width = old[0].count(b",") + 1
        new = [b",".join(row.split(b",")[:width]) for row in new]
    for number, (one, other) in enumerate(zip_longest(old, new)):
        if one == other:
            continue
        if one is None or other is None:
            return f"{later.name}: {len(old)} rows before, {len(new)} rows now"
        if not is_table or number == 0:
            return f"{later.name}: {'header' if is_table else f'message {number}'}: {one!r} before, {other!r} now"
        values = zip(old[0].split(b","), one.split(b","), other.split(b","), strict=True)
        column, before, now = next(each for each in values if each[1] != each[2])
        return f"{later.name}: row {number}, {column.decode()}: {before.decode()} before, {now.decode()} now"
    return ""


def largest_difference(earlier: Path, later: Path) -> str:
    """Return the largest differences of any column within the first seconds of two tables, and in all."""
    old, new = (read_table(path) for path in (earlier, later))
    rows = min(len(old), len(new))
    numbers = [name for name in old.dtype.names if old.dtype[name].kind == "f" and not np.isnan(old[name]).all()]
    off = {name: np.nan_to_num(np.abs(old[name][:rows] - new[name][:rows])) for name in numbers}
    begin = old["time_s"][:rows] <= old["time_s"][0] + FIRST_SECONDS
    first, all_in = (max((o[part].max(initial=0.0), name) for name, o in off.items()) for part in (begin, slice(None)))
    return f"at most {first[0]:.2g} in the first {FIRST_SECONDS:g} s ({first[1]}), {all_in[0]:.2g} in all ({all_in[1]})"


def _rows(data: bytes, is_table: bool) -> list[bytes]:
    return data.splitlines() if is_table else list(_frames(data))


def checksums(folder: Path) -> dict[str, str]:
    """Return the SHA-256 checksums of the records in a run folder, by file."""
    tables = [file for file in FILES if file.endswith(".csv") and (folder / file).exists()]
    found = {file: _sha256((folder / file).read_bytes()) for file in tables}
    frames = [*_frames((folder / "telemetry.tlog").read_bytes())]
    found["telemetry.tlog"] = _sha256(b"".join(frames))
    found[WITHOUT_TEXT] = _sha256(b"".join(map(_without_text, frames)))
    return found


def _frames(log: bytes) -> Iterator[bytes]:
    """Yield the MAVLink frames of a log without their time stamps."""
    at = 0
    while at < len(log):
        begin = at + _STAMP_LENGTH
        at = begin + 12 + log[begin + 1]  # MAVLink 2, unsigned
        yield log[begin:at]


def _without_text(frame: bytes) -> bytes:
    is_text = int.from_bytes(frame[7:10], "little") == _STATUSTEXT
    return frame[:11] if is_text else frame


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def versions() -> dict[str, str]:
    """Return the versions of all that the checksums depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def main() -> int:
    """Compare, or renew; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("flights", nargs="*", choices=[[], *GOLDEN], metavar="FLIGHT", help=", ".join(GOLDEN))
    parser.add_argument("--base", default="HEAD~1", metavar="COMMIT", help="compare with this (default: %(default)s)")
    parser.add_argument("--renew", action="store_true", help="write the checksums of these flights anew")
    options = parser.parse_args()
    names = options.flights or [*GOLDEN]
    on_file = json.loads(CHECKSUMS.read_text(encoding="utf-8")) if CHECKSUMS.exists() else {"flights": {}}
    unlike = _unlike(on_file.get("versions", {}))
    if unlike:
        print(f"checksums on file: not compared, {unlike}", flush=True)
    unequal = 0
    with ExitStack() as context:
        base = None if options.renew else context.enter_context(tree_of(options.base))
        pool = context.enter_context(ThreadPoolExecutor(len(os.sched_getaffinity(0))))
        for name, found, differing in pool.map(partial(compare, base=base), names):
            verdicts = [] if options.renew else [f"differs from {options.base}" if differing else "equal"]
            files = _differing(on_file["flights"].get(name, {}), found)
            if files and (options.renew or not unlike):
                verdicts.append(f"{'renewed' if options.renew else 'not as on file'}: {', '.join(files)}")
            print(f"{name}: {'; '.join(verdicts)}", *differing, sep="\n  ", flush=True)
            unequal += bool(differing) or (bool(files) and not unlike)
            on_file["flights"][name] = found
    if options.renew:
        ordered = {name: on_file["flights"][name] for name in GOLDEN if name in on_file["flights"]}
        content = json.dumps({"versions": versions(), "flights": ordered}, indent=2)
        CHECKSUMS.write_text(content + "\n", encoding="utf-8")
        return 0
    print(f"{len(names) - unequal} of {len(names)} flights are equal")
    return 1 if unequal else 0


def _unlike(on_file: dict[str, str]) -> str:
    """Return why checksums of the versions ``on_file`` do not hold here; empty if they do."""
    other = _differing(on_file, versions())
    return f"they are of other versions: {', '.join(other)}" if other else differences()


def _differing(one: dict[str, str], other: dict[str, str]) -> list[str]:
    return [key for key in {**one, **other} if one.get(key) != other.get(key)]


if __name__ == "__main__":
    sys.exit(main())
