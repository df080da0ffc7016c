"""Parts that only a plan has: surveys, fences, rally points."""

import json
import math
from pathlib import Path

import pytest
from mission_files import CIRCLE, DEGREE, HOME, RETURN, TAKE_OFF, A, B, area, legs, north, plan, read, row, survey

from gcs.flight.feasibility import preflight
from gcs.mission.plan import read_plan
from gcs.mission.route import FlyTo
from idc_controller.geometry.shapes import Pole, Wall


def test_survey_is_flown_by_its_stored_items(tmp_path: Path) -> None:
    mission = read(tmp_path, plan(mission__items=[survey()]))
    assert north(mission) == [10, 20, 0]
    assert legs(mission)[1].source == "item 1.1 (NAV_WAYPOINT)"
    assert any(note.startswith("item 1.2 (DO_SET_CAM_TRIGG_DIST)") for note in mission.notes)
    corridor = survey(complexItemType="CorridorScan", version=2)
    assert north(read(tmp_path, plan(mission__items=[corridor]))) == [10, 20, 0]


def test_fence_of_plan_is_read(tmp_path: Path) -> None:
    triangle = area(5)
    del triangle["polygon"][0]
    document = plan(
        TAKE_OFF,
        A,
        RETURN,
        geoFence__circles=[CIRCLE],
        geoFence__polygons=[area(5), triangle, area(70, inclusion=True)],
    )
    mission = read(tmp_path, document)
    pole, box, *edges = mission.obstacles
    assert isinstance(pole.shape, Pole) and isinstance(box.shape, Wall)
    assert pole.position[:2] == pytest.approx((30.0, 0.0), abs=0.1)
    assert (pole.shape.radius, pole.known, pole.motion) == (5.0, True, None)
    assert box.position[:2] == pytest.approx((30.0, 0.0), abs=0.1)
    assert box.shape.size[:2] == pytest.approx((10.0, 10.0), abs=0.1)
    assert box.position[2] == -box.shape.size[2] / 2
    assert len(edges) == 3
    assert all(isinstance(e.shape, Wall) and math.dist(e.position[:2], (30.0, 0.0)) < 5.2 for e in edges)
    assert mission.boundary[0][0] == pytest.approx((100.0, 70.0), abs=0.5)


def test_legs_across_the_fence_are_noted(tmp_path: Path) -> None:
    behind = row(16, north=60.0)
    for fence in ({"geoFence__circles": [CIRCLE]}, {"geoFence__polygons": [area(5)]}):
        (way, back) = preflight(read(tmp_path, plan(TAKE_OFF, behind, RETURN, **fence))).ways
        assert way.startswith("item 2 (NAV_WAYPOINT): fence ") and back.startswith("item 3 ")
        assert not preflight(read(tmp_path, plan(TAKE_OFF, A, RETURN, **fence))).lines


def test_walls_are_inside_their_polygon(tmp_path: Path) -> None:
    for turn in (1, -1):  # either sense
        kite = area(5)
        kite["polygon"] = [*kite["polygon"], [HOME[0] + 28 / DEGREE, HOME[1] + 15 / DEGREE]][::turn]
        for wall in read(tmp_path, plan(TAKE_OFF, A, RETURN, geoFence__polygons=[kite])).obstacles:
            assert isinstance(wall.shape, Wall)
            if abs(wall.position[0] - 35.0) < 0.2:  # the northern edge
                assert 34.8 < wall.position[0] < 34.99
                break
        else:
            pytest.fail("no northern edge")


def test_rally_points_are_noted_as_unsupported(tmp_path: Path) -> None:
    mission = read(tmp_path, plan(TAKE_OFF, A, RETURN, rallyPoints__points=[[47, 8, 1]]))
    assert mission.notes[0].startswith("rallyPoints: 1 left out")


@pytest.mark.parametrize(("number", "firmware"), [(3, "ardupilot"), (12, "px4"), (0, None), (None, None)])
def test_plan_names_the_autopilot_it_is_written_for(number: int | None, firmware: str | None) -> None:
    text = json.dumps(plan(TAKE_OFF, A, mission__firmwareType=number))
    assert read_plan(Path("x.plan"), text).firmware == firmware


@pytest.mark.parametrize(
    ("mission", "flown", "noted"),
    [
        ({"hoverSpeed": 2}, 2.0, False),
        ({"hoverSpeed": 2.5, "vehicleType": 2}, 2.5, False),
        ({"hoverSpeed": 5, "cruiseSpeed": 15, "vehicleType": 2}, 3.0, True),
        ({"hoverSpeed": 0.5, "cruiseSpeed": 15, "vehicleType": 1}, 1.5, False),
        ({"hoverSpeed": 0}, 1.5, False),
        ({"hoverSpeed": None, "cruiseSpeed": 15}, 1.5, False),
    ],
)
def test_hover_speed_of_plan_is_flown_up_to_the_largest(
    tmp_path: Path, mission: dict[str, float], flown: float, noted: bool
) -> None:
    document = plan(TAKE_OFF, A, RETURN)
    document["mission"].update(mission)
    read_mission = read(tmp_path, document)
    assert {leg.speed for leg in legs(read_mission) if isinstance(leg, FlyTo)} == {flown}
    assert read_mission.notes == (("hoverSpeed: 5 m/s capped to speed_max, 3 m/s",) if noted else ())


def test_speed_of_toml_precedes_hover_speed(tmp_path: Path) -> None:
    (tmp_path / "route.plan").write_text(json.dumps(plan(TAKE_OFF, A, row(178, 1, 2), A, row(178, 1, -2), B, RETURN,
                                                         mission__hoverSpeed=2.5)))  # fmt: skip
    toml = '[mission]\nname = "x"\n[reference]\nkind = "waypoints"\nfile = "route.plan"\n'
    for text, speed in ((toml, 2.5), (toml + "speed = 0.5\n", 0.5)):
        flown = [leg.speed for leg in legs(read(tmp_path, text, "mission.toml")) if isinstance(leg, FlyTo)]
        assert flown == [speed, 2.0, speed, speed]
