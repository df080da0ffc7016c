"""The missions of this project, and the description of a mission for the operator."""

import math
from pathlib import Path

import pytest
from mission_files import (
    CIRCLE,
    MISSIONS,
    RETURN,
    TAKE_OFF,
    TOML,
    A,
    B,
    description_of,
    legs,
    plan,
    read,
    row,
    shape,
    wpl,
)

from gcs.mission.model import Lissajous
from gcs.mission.read import read_mission
from gcs.mission.route import FlyTo, Land
from idc_controller.geometry.shapes import Pole, Wall


def test_description_of_hover() -> None:
    mission = read_mission(MISSIONS / "hover.toml")
    assert [s[:4] for s in shape(mission)] == [("TakeOff", 0, 0, -5), ("FlyTo", 0, 0, -5), ("Land", 0, 0, -0.3)]
    assert shape(mission)[1][4] == 15.0


def test_description_of_figure_eight() -> None:
    mission = read_mission(MISSIONS / "figure_eight.toml")
    assert mission.reference == Lissajous((6.0, 3.0), 0.5, 5.0, 40.0)
    assert mission.limits is not None and mission.limits.position_rmse == 0.03


def test_description_of_square() -> None:
    mission = read_mission(MISSIONS / "square.waypoints")
    lap = [(10, 0, 0), (10, 10, 3), (0, 10, 0), (0, 0, 3)]
    flown = [(round(n), round(e), hold) for kind, n, e, _, hold, _ in shape(mission)[1:-1]]
    assert flown == lap * 2
    assert isinstance(legs(mission)[-1], Land)
    assert mission.notes == ()


def test_description_of_delivery() -> None:
    mission = read_mission(MISSIONS / "delivery.plan")
    assert isinstance(legs(mission)[-1], Land)
    assert math.hypot(*legs(mission)[-1].position[:2]) == pytest.approx(20.0, abs=0.5)
    assert {leg.speed for leg in legs(mission) if isinstance(leg, FlyTo)} == {1.0, 1.5, 2.0}
    assert mission.notes == ()


def test_description_of_fenced_delivery() -> None:
    mission = read_mission(MISSIONS / "fenced_delivery.plan")
    circle, polygon = mission.obstacles
    assert isinstance(circle.shape, Pole) and circle.shape.radius == 2.0 and circle.known
    assert isinstance(polygon.shape, Wall) and polygon.shape.size[:2] == pytest.approx((3.0, 5.0), abs=0.01)
    assert [len(ring) for ring in mission.boundary] == [4]
    assert mission.notes == ()


@pytest.mark.parametrize("name", ["hover.toml", "figure_eight.toml", "square.waypoints", "delivery.plan"])
def test_description_of_mission_file(name: str) -> None:
    text = description_of(read_mission(MISSIONS / name))
    assert "home 47.3977420, 8.5455940, 488 m" in text
    assert ("figure eight of 12 x 6 m" if name == "figure_eight.toml" else " m, about ") in text


def test_description_lists_all_settings(tmp_path: Path) -> None:
    endless = plan(TAKE_OFF, A, B, row(177, 2, -1), RETURN, geoFence__circles=[CIRCLE])
    for content, name, expected in [
        (endless, "mission.plan", ["endless", "never reached", "pole 'fence circle 1'"]),
        (wpl(TAKE_OFF, row(17, north=5.0)), "mission.txt", ["holds until stopped"]),
        (
            wpl(row(93, 3), TAKE_OFF, row(18, 2, 0, 4, north=5.0)),
            "mission.txt",
            ["wait 3 s", "circle 2 x 4 m clockwise"],
        ),
        (TOML, "mission.toml", ["packet_loss from 20 s for 5 s, vehicles 2", "not on the map", "clearance 0.3 m"]),
    ]:
        text = description_of(read(tmp_path, content, name))
        for part in expected:
            assert part in text, part
