"""Fly short missions and compare the checksums of their records with those on file.

A refactoring that is meant to change no behaviour changes no checksum:

  python tests/golden/golden.py                  compare; exit status 1 when a flight differs
  python tests/golden/golden.py leg spheres_1    compare these flights only
  python tests/golden/golden.py --renew          write the checksums anew, on purpose
  python tests/golden/golden.py --records DIR    keep the records in DIR; where DIR has those of an earlier run (of the
                                                 commit before, say), print the first row and column that differ, and
                                                 the largest differences

The checksums hold for the versions that `checksums.json` names, and for one kind of processor. `telemetry.tlog` is
compared twice: whole, and without the texts of its STATUSTEXT messages, so that a reworded message can be distinguished
from another flight.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import multiprocessing
import platform
import shutil
import sys
import tempfile
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version
from itertools import zip_longest
from pathlib import Path

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

import pandas as pd  # noqa: E402
import pymavlink.dialects.v20.common as mavlink  # noqa: E402
from flight_in_process import InProcessFlight  # noqa: E402
from threadpoolctl import threadpool_limits  # noqa: E402

from gcs.flight.failsafe import Failsafe  # noqa: E402
from gcs.mission.read import read_mission  # noqa: E402

CHECKSUMS = HERE / "checksums.json"
MISSIONS = HERE / "missions"
FILES = ("truth.csv", "reference.csv", "estimate.csv", "plan.csv", "telemetry.tlog")
PACKAGES = (
    "coal",
    "daqp",
    "filterpy",
    "numba",
    "numpy",
    "proxsuite",
    "pybullet",
    "pymavlink",
    "scipy",
    "shapely",
    "trimesh",
)
WITHOUT_TEXT = "telemetry.tlog without STATUSTEXT"
_STATUSTEXT = mavlink.MAVLINK_MSG_ID_STATUSTEXT
_STAMP_LENGTH = 8
FIRST_SECONDS = 5.0


@dataclass(frozen=True)
class Golden:
    """One flight: a mission file, tables appended to it, a seed, and what is done to the flight at each exchange.

    ``detected``: the mission's obstacles are in the world, too, where the range sensors detect them.
    """

    mission: Path
    tables: str = ""
    seed: int = 1
    detected: bool = False
    on_exchange: Callable[[InProcessFlight], None] = lambda flight: None


def interrupt_at_8_seconds(flight: InProcessFlight) -> None:
    """Break the flight off as Ctrl-C does."""
    if flight.now >= 8.0:
        flight.station.raise_failsafe(flight.now, Failsafe.INTERRUPTED, "interrupted")


def fault(kind: str, keys: str) -> str:
    """Return the table of a fault in a mission file."""
    return f'\n[[fault]]\nkind = "{kind}"\n{keys}\n'


GOLDEN = {
    "figure_eight": Golden(MISSIONS / "figure_eight.toml"),
    "spheres_1": Golden(MISSIONS / "spheres.toml", seed=1),
    "spheres_2": Golden(MISSIONS / "spheres.toml", seed=2),
    "spheres_3": Golden(MISSIONS / "spheres.toml", seed=3),
    "spheres_detected": Golden(MISSIONS / "spheres.toml", detected=True),
    "poles": Golden(MISSIONS / "poles.toml"),
    "square": Golden(MISSIONS / "square.waypoints"),
    "delivery": Golden(HERE.parents[1] / "missions" / "fenced_delivery.plan"),
    "leg": Golden(MISSIONS / "leg.toml"),
    "fault_link": Golden(
        MISSIONS / "leg.toml",
        fault("packet_loss", "start = 0.0\nprobability = 0.1")
        + fault("jitter", "start = 4.0\nspread = 0.02"),
    ),
    "fault_timing": Golden(MISSIONS / "leg.toml", fault("clock_step", "start = 6.0\nvehicles = [2]\nstep = 0.3")),
    "fault_values": Golden(
        MISSIONS / "leg.toml",
        fault("bias", 'start = 5.0\nvehicles = [2]\nchannel = "position"\namount = 0.5\naxes = ["x"]'),
    ),
    "fault_sensors": Golden(
        MISSIONS / "leg.toml", fault("position_lost", "start = 6.0\nduration = 3.0\nvehicles = [1]")
    ),
    "fault_world": Golden(MISSIONS / "leg.toml", fault("wind", "start = 2.0\nvelocity = [0.0, 2.0, 0.0]\ngust = 0.5")),
    "vehicle_lost": Golden(
        MISSIONS / "leg.toml", fault("partition", 'start = 7.0\nvehicles = [3]\ndirection = "telemetry"')
    ),
    "interrupted": Golden(MISSIONS / "leg.toml", on_exchange=interrupt_at_8_seconds),
}  # fmt: skip


def fly(name: str, records: Path | None = None) -> tuple[str, dict[str, str], list[str]]:
    """Return the name, the SHA-256 checksums by file, and the first differences from earlier ``records``."""
    golden = GOLDEN[name]
    with tempfile.TemporaryDirectory() as scratch, threadpool_limits(limits=1):
        mission, folder = golden.mission, Path(scratch) / "run"
        if golden.tables:
            mission = Path(scratch) / golden.mission.name
            system = HERE.parents[1] / "missions" / "system.toml"
            text = golden.mission.read_text(encoding="utf-8")
            text = text.replace('"../../../missions/system.toml"', json.dumps(str(system)))
            mission.write_text(text + golden.tables, encoding="utf-8")
        obstacles = read_mission(mission).obstacles if golden.detected else ()
        with InProcessFlight(mission, folder, seed=golden.seed, obstacles=obstacles) as flight:
            flight.fly(golden.on_exchange)
        differences = []
        if records is not None:
            earlier = records / name
            if earlier.exists():
                differences = [text for file in FILES if (text := first_difference(earlier / file, folder / file))]
                differences += [
                    f"{file}: {largest_difference(earlier / file, folder / file)}"
                    for file in FILES
                    if file.endswith(".csv") and any(text.startswith(file) for text in differences)
                ]
            else:
                shutil.copytree(folder, earlier)
        return name, checksums(folder), differences


def first_difference(earlier: Path, later: Path) -> str:
    """Return the first row and column in which two records differ, with both values; empty where they are equal."""
    is_table = later.suffix == ".csv"
    old, new = (_rows(path.read_bytes(), is_table) for path in (earlier, later))
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
    old, new = (pd.read_csv(path).select_dtypes("number") for path in (earlier, later))
    rows = min(len(old), len(new))
    off = (old.iloc[:rows] - new.iloc[:rows]).abs()
    first = off[old.iloc[:rows, 0] <= old.iloc[0, 0] + FIRST_SECONDS].max()
    return (
        f"at most {first.max():.2g} in the first {FIRST_SECONDS:g} s ({first.idxmax()}), "
        f"{off.max().max():.2g} in all ({off.max().idxmax()})"
    )


def _rows(data: bytes, is_table: bool) -> list[bytes]:
    return data.splitlines() if is_table else list(_records(data))


def checksums(folder: Path) -> dict[str, str]:
    """Return the SHA-256 checksums of the records in a run folder, by file."""
    found = {file: _sha256((folder / file).read_bytes()) for file in FILES}
    log = (folder / "telemetry.tlog").read_bytes()
    found[WITHOUT_TEXT] = _sha256(b"".join(map(_without_text, _records(log))))
    return found


def _records(log: bytes) -> Iterator[bytes]:
    at = 0
    while at < len(log):
        length = _STAMP_LENGTH + 12 + log[at + _STAMP_LENGTH + 1]  # MAVLink 2, unsigned
        yield log[at : at + length]
        at += length


def _without_text(record: bytes) -> bytes:
    is_text = int.from_bytes(record[_STAMP_LENGTH + 7 : _STAMP_LENGTH + 10], "little") == _STATUSTEXT
    return record[: _STAMP_LENGTH + 11] if is_text else record


def _sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def versions() -> dict[str, str]:
    """Return the versions of all that the checksums depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in PACKAGES}}


def main() -> int:
    """Compare, or renew; return the exit status."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("flights", nargs="*", choices=[[], *GOLDEN], metavar="FLIGHT", help=", ".join(GOLDEN))
    parser.add_argument("--renew", action="store_true", help="write the checksums of these flights anew")
    parser.add_argument("--records", type=Path, metavar="DIR", help="folder of the records of this or an earlier run")
    options = parser.parse_args()
    names = options.flights or [*GOLDEN]
    on_file = json.loads(CHECKSUMS.read_text(encoding="utf-8")) if CHECKSUMS.exists() else {"flights": {}}
    if not options.renew and (other := _differing(on_file["versions"], versions())):
        print(f"the checksums on file are of other versions ({', '.join(other)}): compare with those, or --renew")
        return 2
    differing = 0
    with multiprocessing.get_context("spawn").Pool() as pool:
        for name, found, differences in pool.imap_unordered(partial(fly, records=options.records), names, chunksize=1):
            files = _differing(on_file["flights"].get(name, {}), found)
            differing += bool(files)
            verdict = "equal" if not files else ("renewed: " if options.renew else "differs: ") + ", ".join(files)
            print(f"{name}: {verdict}", *differences, sep="\n  ", flush=True)
            on_file["flights"][name] = found
    if options.renew:
        ordered = {name: on_file["flights"][name] for name in GOLDEN if name in on_file["flights"]}
        CHECKSUMS.write_text(
            json.dumps({"versions": versions(), "flights": ordered}, indent=2) + "\n", encoding="utf-8"
        )
        return 0
    print(f"{len(names) - differing} of {len(names)} flights are equal")
    if differing and options.records is None:
        print("--records DIR, before and after the change, names the first row and column that differ")
    return 1 if differing else 0


def _differing(one: dict[str, str], other: dict[str, str]) -> list[str]:
    return [key for key in {**one, **other} if one.get(key) != other.get(key)]


if __name__ == "__main__":
    sys.exit(main())
