"""The map that ``gcs check --plot`` draws."""

import math

import numpy as np
import pytest
from mission_files import MISSIONS

from gcs.app.cli import main
from gcs.errors import UnusableInput
from gcs.mission.read import read_mission
from gcs.view.mission_map import draw_map, least_clearance, swept_area, write_map
from idc_controller.geometry.free_space import BoundingCylinder

COURSE = """
[mission]
name = "past a pole"

[reference]
kind = "waypoints"
points = [[20.0, 0.0, -5.0], [20.0, 10.0, -5.0], [20.0, 0.0, -5.0]]
speed = 2.0
return_home = false

[[obstacle]]
name = "mast"
shape = "pole"
position = [8.0, {east}]
radius = 0.5
height = 12.0
known = {known}
"""


def course(folder, east=3.0, known="true"):
    (folder / "course.toml").write_text(COURSE.format(east=east, known=known))
    return read_mission(folder / "course.toml")


def test_swept_area_is_that_of_the_bounds_along_each_line():
    formation = BoundingCylinder(2.0, 3.0, 0.3, core=(0.5, 0.4), rounding=0.3)
    straight = swept_area(np.array([[0.0, 0.0, -5.0], [10.0, 0.0, -5.0]]), formation)
    assert straight.bounds == pytest.approx((-0.8, -0.7, 10.8, 0.7))
    assert straight.area == pytest.approx(11.0 * 0.8 + 2 * 0.3 * (11.0 + 0.8) + math.pi * 0.09, rel=1e-3)
    there_and_back = swept_area(np.array([[0.0, 0.0, -5.0], [10.0, 0.0, -5.0], [0.0, 0.0, -9.0]]), formation)
    assert there_and_back.equals_exact(straight, 1e-9) or there_and_back.symmetric_difference(straight).area < 1e-6


def test_least_clearance_is_measured_from_the_bounds_to_what_stands_on_the_map(tmp_path):
    mission = course(tmp_path)
    formation = BoundingCylinder.of(mission.system.parameters())
    places = np.array([[0.0, 0.0, -0.3], [0.0, 0.0, -5.0], [20.0, 0.0, -5.0]])
    place, obstacle, clearance = least_clearance(mission, places)
    assert obstacle.name == "mast" and place[0] == pytest.approx(8.0, abs=formation.core[0] + 0.5 + 0.2)
    assert clearance == pytest.approx(3.0 - 0.5 - formation.core[1] - formation.rounding, abs=0.01)
    assert least_clearance(course(tmp_path, known="false"), places) is None


def test_map_shows_legs_fence_obstacles_and_the_least_clearance(tmp_path):
    (ax,) = draw_map(course(tmp_path)).axes
    texts = [text.get_text() for text in ax.texts]
    assert {"1", "2, 4, 5", "3", "mast"} <= set(texts) or {"1", "2, 4", "3", "mast"} <= set(texts), texts
    assert any("m to mast, 5.0 m high" in text for text in texts)
    assert ax.get_xlim()[0] < 0.0 < 10.0 < ax.get_xlim()[1] and ax.get_ylim()[1] > 20.0
    (ax,) = draw_map(course(tmp_path, east=0.0)).axes
    assert any("leads into mast" in text.get_text() for text in ax.texts)
    (ax,) = draw_map(read_mission(MISSIONS / "fenced_delivery.plan")).axes
    assert {"fence: stay inside", "fence: keep out"} <= set(ax.get_legend_handles_labels()[1])


def test_map_is_written_as_the_suffix_says_or_refused(tmp_path):
    mission = course(tmp_path)
    for name, magic in (("map.png", b"\x89PNG"), ("map.svg", b"<?xml"), ("map.pdf", b"%PDF")):
        write_map(mission, tmp_path / name)
        assert (tmp_path / name).read_bytes().startswith(magic)
    with pytest.raises(UnusableInput, match=r"map.xyz: images of kind 'xyz' are not written, only of .*png"):
        write_map(mission, tmp_path / "map.xyz")
    with pytest.raises(UnusableInput, match=r"none/map.png: cannot be written: No such file"):
        write_map(mission, tmp_path / "none" / "map.png")


def test_command_writes_the_map(tmp_path, capsys):
    mission = str(course(tmp_path).path)
    assert main(["check", mission, "--plot", str(tmp_path / "map.svg")]) == 0
    assert "legs" in capsys.readouterr().out and b"</svg>" in (tmp_path / "map.svg").read_bytes()
    assert main(["check", mission, "--plot", str(tmp_path / "map.xyz")]) == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
