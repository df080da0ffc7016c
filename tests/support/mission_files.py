"""Mission files for tests, and what is read of them."""

import json
import math
from itertools import islice
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from gcs.config import UnusableFile
from gcs.mission.describe import describe
from gcs.mission.model import Mission
from gcs.mission.read import read_mission
from gcs.mission.route import Circle, FlyTo, Leg, Route, TakeOff

MISSIONS = Path(__file__).parents[2] / "missions"
HOME = (47.397742, 8.545594, 488.0)
DEGREE = 111_194.0  # m of latitude, roughly

Row = tuple[float | str, ...]


def row(command: int, *params: float, frame: int = 3, north: float | None = None, alt: float = 5.0) -> Row:
    """frame, command, params: at ``north`` metres from home, or with latitude and longitude 0."""
    four = (*params, 0, 0, 0, 0)[:4]
    place = (0, 0) if north is None else (round(HOME[0] + north / DEGREE, 8), HOME[1])
    return (frame, command, *four, *place, alt)


TAKE_OFF = row(22)
A, B = row(16, north=10.0), row(16, north=20.0)
RETURN = row(20, alt=0)


def wpl(*rows: Row, home: str = f"0 16 0 0 0 0 {HOME[0]} {HOME[1]} {HOME[2]}") -> str:
    lines = ["QGC WPL 110", *(f"{i}\t0\t{r}\t1" for i, r in enumerate([home, *(" ".join(map(str, r)) for r in rows)]))]
    return "\n".join(lines).replace(" ", "\t").replace("QGC\tWPL\t", "QGC WPL ") + "\n"


def simple(r: Row, number: int) -> dict[str, Any]:
    return {
        "type": "SimpleItem", "autoContinue": True, "doJumpId": number, "frame": r[0], "command": r[1],
        "params": list(r[2:]),
    }  # fmt: skip


def plan(*rows: Row, **changes: Any) -> dict[str, Any]:
    document: dict[str, Any] = {
        "fileType": "Plan", "groundStation": "QGroundControl", "version": 1,
        "geoFence": {"circles": [], "polygons": [], "version": 2},
        "rallyPoints": {"points": [], "version": 2},
        "mission": {
            "version": 2, "items": [simple(r, i) for i, r in enumerate(rows, start=1)],
            "plannedHomePosition": list(HOME),
        },
    }  # fmt: skip
    for key, value in changes.items():
        table = document
        *path, last = key.split("__")
        for part in path:
            table = table[part]
        table[last] = value
    return document


def read(tmp_path: Path, content: str | bytes | dict[str, Any], name: str = "mission.waypoints") -> Mission:
    if isinstance(content, dict):
        content, name = json.dumps(content), "mission.plan"
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return read_mission(path)


def legs(mission: Mission, at_most: int = 50) -> list[Leg]:
    assert isinstance(mission.reference, Route)
    return list(islice(mission.reference.legs(), at_most))


def shape(mission: Mission, at_most: int = 50) -> list[tuple[Any, ...]]:
    """Legs without the lines they come from, rounded to the centimetre."""
    found: list[tuple[Any, ...]] = []
    for leg in legs(mission, at_most):
        place = leg.centre if isinstance(leg, Circle) else leg.position
        extra = {
            TakeOff: lambda g: (g.delay,), FlyTo: lambda g: (g.hold, g.speed),
            Circle: lambda g: (g.radius, g.turns, g.clockwise),
        }.get(type(leg), lambda g: ())(leg)  # fmt: skip
        found.append((type(leg).__name__, *(round(x, 2) + 0.0 for x in place), *extra))
    return found


def north(mission: Mission, at_most: int = 50) -> list[int]:
    """Metres north of home of the places flown to."""
    return [round(leg.position[0]) for leg in legs(mission, at_most) if isinstance(leg, FlyTo)]


def refusal(tmp_path: Path, content: str | bytes | dict[str, Any], name: str = "mission.waypoints") -> tuple[str, ...]:
    with pytest.raises(UnusableFile) as caught:
        read(tmp_path, content, name)
    for reason in caught.value.reasons:
        assert reason.startswith(f"{tmp_path}/mission."), reason
        assert "\n" not in reason
    return caught.value.reasons


def description_of(mission: Mission) -> str:
    console = Console(width=200)
    with console.capture() as capture:
        console.print(describe(mission))
    return capture.get()


def survey(**changes: Any) -> dict[str, Any]:
    transects = {"version": 1, "Items": [simple(A, 1), simple(row(206, 25, frame=2), 2), simple(B, 3)]}
    item = {"type": "ComplexItem", "complexItemType": "survey", "version": 5, "TransectStyleComplexItem": transects}
    return {**item, **changes}


CIRCLE = {"circle": {"center": [HOME[0] + 30 / DEGREE, HOME[1]], "radius": 5.0}, "inclusion": False, "version": 1}


def area(half: float, **changes: Any) -> dict[str, Any]:
    """A square of 2 ``half`` about 30 m north of home."""
    to_lat, to_lon = 1 / DEGREE, 1 / (DEGREE * math.cos(math.radians(HOME[0])))
    corners = [(30 + half, half), (30 + half, -half), (30 - half, -half), (30 - half, half)]
    polygon = [[HOME[0] + n * to_lat, HOME[1] + e * to_lon] for n, e in corners]
    return {"polygon": polygon, "inclusion": False, "version": 1, **changes}


def polygon(*corners: tuple[float, float], inclusion: bool = True) -> dict[str, Any]:
    """A part of a fence, by its corners in metres north and east of home."""
    to_lon = 1 / (DEGREE * math.cos(math.radians(HOME[0])))
    places = [[HOME[0] + north / DEGREE, HOME[1] + east * to_lon] for north, east in corners]
    return {"polygon": places, "inclusion": inclusion, "version": 1}


TOML = """
[mission]
name = "two spheres"
seed = 7

[reference]
kind = "lissajous"
amplitude = [6.0, 3.0]
angular_frequency = 0.5
altitude = 5.0
duration = 40.0

[[obstacle]]
name = "static"
shape = "sphere"
position = [-6.0, 0.0, -5.0]
radius = 0.5
known = true

[[obstacle]]
name = "moving"
shape = "pole"
position = [6.0, 0.0]
radius = 0.5
height = 15.0
known = false
motion = { kind = "harmonic", amplitude = [1.5, 0.0, 0.0], angular_frequency = 1.0, phase = 3.14159 }

[[fault]]
kind = "packet_loss"
vehicles = [2]
direction = "telemetry"
start = 20.0
duration = 5.0
probability = 0.3

[limits]
position_rmse = 0.05
settle = 10.0
payload_tilt_deg = 5.0
clearance = 0.3
"""
POINTS = (
    '[mission]\nname = "p"\n[reference]\nkind = "waypoints"\npoints = [[1, 2, -3], [4, 5, -6]]\nspeed = 2\nhold = 4\n'
)
