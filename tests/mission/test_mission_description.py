"""The missions of this project, and the description of a mission for the operator."""

from pathlib import Path

import pytest
from mission_files import CIRCLE, MISSIONS, RETURN, TAKE_OFF, TOML, A, B, description_of, plan, read, row, wpl

from gcs.mission.read import read_mission


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
