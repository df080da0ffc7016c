"""The project's own format of missions."""

from pathlib import Path

import pytest
from mission_files import MISSIONS, POINTS, TAKE_OFF, TOML, A, read, refusal, row, shape, wpl

from gcs.config import UnusableFile
from gcs.mission.model import Lissajous
from gcs.mission.read import read_mission
from gcs.mission.route import Route
from idc_controller.geometry.shapes import Pole, Sphere


def test_toml(tmp_path: Path) -> None:
    mission = read(tmp_path, TOML, "mission.toml")
    assert mission.reference == Lissajous((6.0, 3.0), 0.5, 5.0, 40.0)
    assert (mission.name, mission.seed) == ("two spheres", 7)
    static, moving = mission.obstacles
    assert isinstance(static.shape, Sphere) and isinstance(moving.shape, Pole)
    assert static.known and not moving.known
    assert moving.motion is not None and moving.motion.kind == "harmonic"
    (fault,) = mission.faults
    assert (fault.kind, fault.vehicles, fault.direction, fault.start, fault.duration) == (
        "packet_loss",
        (2,),
        "telemetry",
        20,
        5,
    )
    assert fault.settings == {"probability": 0.3}
    assert TOML.splitlines()[fault.line - 1] == "[[fault]]"
    assert mission.limits is not None and mission.limits.clearance == 0.3


def test_toml_points(tmp_path: Path) -> None:
    assert shape(read(tmp_path, POINTS, "mission.toml")) == [
        ("TakeOff", 0.0, 0.0, -3.0, 0.0),
        ("FlyTo", 1.0, 2.0, -3.0, 4.0, 2.0),
        ("FlyTo", 4.0, 5.0, -6.0, 4.0, 2.0),
        ("FlyTo", 0.0, 0.0, -6.0, 0.0, 2.0),
        ("Land", 0.0, 0.0, -0.3),
    ]


@pytest.mark.parametrize(
    ("text", "old", "new", "at", "reason"),
    [
        (TOML, 'name = "two spheres"', "", "[mission]", "mission.name: missing key"),
        (TOML, "seed = 7", "sead = 7", "seed", "mission.sead: unknown key"),
        (TOML, "seed = 7", "seed = -7", "seed", "mission.seed: "),
        (TOML, "seed = 7", 'system = "none.toml"', "seed", "mission.system: there is no file none.toml"),
        (TOML, 'kind = "lissajous"', 'kind = "circle"', 'kind = "liss', "reference.kind: 'circle' is none of"),
        (TOML, 'kind = "lissajous"', "", "[reference]", "reference.kind: missing key"),
        (TOML, "altitude = 5.0", "altitude = -5.0", "altitude", "reference.altitude: "),
        (TOML, "duration = 40.0", "duration = 0.0", "duration = 40", "reference.duration: "),
        (TOML, "duration = 40.0", "", "[reference]", "reference.duration: missing key"),
        (TOML, 'shape = "sphere"', 'shape = "cube"', "shape = ", "obstacle[1].shape: 'cube' is none of"),
        (TOML, 'shape = "sphere"', 'shape = "wall"', "radius", "obstacle[1].radius: unknown key"),
        (TOML, "height = 15.0", "", '[[obstacle]]\nname = "moving"', "obstacle[2].height: missing key"),
        (TOML, "height = 15.0", "height = nan", "height", "obstacle[2].height: "),
        (TOML, "phase = 3.14159", "fase = 3.14159", "motion", "obstacle[2].motion.fase: unknown key"),
        (TOML, "amplitude = [1.5, 0.0, 0.0]", "amplitude = [1.5, 0.0, 1.0]", "motion", "no vertical motion"),
        (TOML, 'name = "moving"', 'name = "static"', 'name = "moving"', "'static' appears 2 times"),
        (TOML, 'direction = "telemetry"', 'direction = "up"', "direction", "fault[1].direction: "),
        (TOML, "vehicles = [2]", "vehicles = [5]", "vehicles", "there is no vehicle 5: the team has 4"),
        (TOML, "start = 20.0", "", "[[fault]]", "fault[1].start: missing key"),
        (TOML, "clearance = 0.3", "clearence = 0.3", "clearance", "limits.clearence: unknown key"),
        (TOML, "[limits]", "[limit]", "[limits]", "limit: unknown key"),
        (TOML, "[[fault]]", "[fault]", "[[fault]]", "fault: "),
        (TOML, "[mission]", "[mission", "[mission]", "not valid TOML"),
        (POINTS, "[4, 5, -6]", "[4, 5, 6]", "points =", "z = 6 m is below ground"),
        (POINTS, "[4, 5, -6]", "[4, 5]", "points =", "reference.points[2]"),
        (POINTS, "[4, 5, -6]", "[4e9, 5, -6]", "points =", "more than 10 km"),
        (POINTS, "[[1, 2, -3], [4, 5, -6]]", "[]", "points =", "reference.points: needs at least 1"),
        (POINTS, "speed = 2", 'file = "x.plan"', "[reference]", "either file or points"),
        (POINTS, "points = [[1, 2, -3], [4, 5, -6]]", "", "[reference]", "either file or points"),
        (POINTS, "points = [[1, 2, -3], [4, 5, -6]]", 'file = "x.plan"', "hold", "goes with points"),
        (POINTS, "speed = 2", "speed = 0", "speed", "reference.speed: "),
    ],
)
def test_toml_refused(tmp_path: Path, text: str, old: str, new: str, at: str, reason: str) -> None:
    assert old in text
    line = text[: text.index(at)].count("\n") + 1
    reasons = refusal(tmp_path, text.replace(old, new, 1), "mission.toml")
    assert any(reason in r and f"line {line}: " in r for r in reasons), reasons


@pytest.mark.parametrize(
    ("text", "old", "new", "reason"),
    [
        (POINTS, "[4, 5, -6]", "[4, nan, -6]", "reference.points[2][2]: must be a finite number, found NaN"),
        (POINTS, "[[1, 2, -3], [4, 5, -6]]", "[[nan, 2, -3]]", "reference.points[1][1]: must be a finite number"),
        (TOML, "duration = 40.0", "duratoin = 40.0", "reference.duratoin: unknown key: did you mean 'duration'?"),
        (TOML, "height = 15.0", "heigth = 15.0", "obstacle[2].heigth: unknown key: did you mean 'height'?"),
    ],
)
def test_one_mistake_is_one_line(tmp_path: Path, text: str, old: str, new: str, reason: str) -> None:
    assert old in text
    (line,) = refusal(tmp_path, text.replace(old, new, 1), "mission.toml")
    assert reason in line


def test_toml_names_a_missing_or_wrong_waypoint_file(tmp_path: Path) -> None:
    text = '[mission]\nname = "p"\n[reference]\nkind = "waypoints"\nfile = "mission.txt"\n'
    assert "line 5: reference.file: there is no file" in refusal(tmp_path, text, "mission.toml")[0]
    (tmp_path / "mission.txt").write_text(wpl(TAKE_OFF, row(84)))
    assert "mission.txt: line 4" in refusal(tmp_path, text, "mission.toml")[0]


def test_speed_of_toml_is_capped(tmp_path: Path) -> None:
    mission = read(tmp_path, POINTS.replace("speed = 2", "speed = 20"), "mission.toml")
    assert isinstance(mission.reference, Route) and mission.reference.speed == 3.0
    assert mission.notes == ("reference.speed: 20 m/s capped to speed_max, 3 m/s",)


def test_system_file_of_mission_is_read(tmp_path: Path) -> None:
    text = (MISSIONS / "system.toml").read_text()
    assert read(tmp_path, wpl(A)).system.payload.mass == 3.1  # packaged
    (tmp_path / "system.toml").write_text(text.replace("mass = 3.1", "mass = 3.2"))
    assert read(tmp_path, wpl(A)).system.payload.mass == 3.2  # beside
    assert read(tmp_path, POINTS, "mission.toml").system.payload.mass == 3.2
    (tmp_path / "heavy.toml").write_text(text.replace("mass = 3.1", "mass = 3.3"))
    named = POINTS.replace('name = "p"', 'name = "p"\nsystem = "heavy.toml"')
    assert read(tmp_path, named, "mission.toml").system.payload.mass == 3.3
    path = tmp_path / "mission.toml"
    assert read_mission(path, tmp_path / "system.toml").system.payload.mass == 3.2  # named on the command line


def test_mission_ends_at_last_point(tmp_path: Path) -> None:
    there = POINTS.replace("speed = 2", "speed = 2\nreturn_home = false")
    assert shape(read(tmp_path, there, "mission.toml"))[-2:] == [
        ("FlyTo", 4.0, 5.0, -6.0, 4.0, 2.0),
        ("Land", 4.0, 5.0, -0.3),
    ]
    back = POINTS.replace("speed = 2", "speed = 2\nreturn_home = true")
    assert shape(read(tmp_path, back, "mission.toml"))[-1] == ("Land", 0.0, 0.0, -0.3)
    file = '[mission]\nname = "p"\n[reference]\nkind = "waypoints"\nfile = "m.txt"\nreturn_home = true\n'
    assert "line 6: reference.return_home: goes with points" in refusal(tmp_path, file, "mission.toml")[0]


@pytest.mark.parametrize(("name", "use"), [("many_hops.toml", "gcs faults flies it"), ("system.toml", "--config")])
def test_unusable_file_is_refused_with_its_purpose(name: str, use: str) -> None:
    with pytest.raises(UnusableFile) as refused:
        read_mission(MISSIONS / name)
    assert len(refused.value.reasons) == 1 and use in refused.value.reasons[0]
