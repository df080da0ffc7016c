"""Missions and campaigns that come with the package, by their names: listed, flown, and nearest to a wrong name."""

import re
from pathlib import Path

import pytest

from gcs.app.cli import main
from gcs.mission.own import named, own_files
from gcs.mission.read import read_mission

MISSIONS = Path(__file__).parents[2] / "missions"


@pytest.fixture(autouse=True)
def elsewhere(tmp_path, monkeypatch):
    """Another project's folder."""
    monkeypatch.chdir(tmp_path)


def test_all_missions_of_the_package_are_listed_with_a_line_each_and_can_be_read(capsys):
    assert main(["missions"]) == 0
    listed = dict(re.findall(r"^  (\w+) +(\w.+)$", capsys.readouterr().out, re.MULTILINE))
    files = own_files() | own_files("campaign")
    assert listed.keys() == files.keys() and {"figure_eight", "square", "delivery", "many_hops"} <= files.keys()
    assert all(MISSIONS / path.name == path for path in files.values())
    assert all(read_mission(name).path == path for name, path in own_files().items())


def test_a_mission_is_checked_by_its_name_where_there_is_no_such_file(tmp_path, capsys):
    (tmp_path / "hop").mkdir()  # a folder is no mission
    assert main(["check", "hop"]) == 0
    assert "hop.toml" in capsys.readouterr().out
    (tmp_path / "hover").write_text((MISSIONS / "square.waypoints").read_text())
    assert named("hover") == Path("hover")


@pytest.mark.parametrize(
    "words, hint",
    [
        (["fly", "figure_eigth"], "; did you mean figure_eight, of the package's own?"),
        (["check", "missions/hop.toml"], "; did you mean hop, of the package's own?"),
        (["faults", "detections"], "; did you mean detection, of the package's own?"),
        (["fly", "xyz"], "; gcs missions lists the package's own"),
        (["fly", "folder/xyz.toml"], ""),
    ],
)
def test_a_wrong_name_is_refused_with_the_nearest(words, hint, capsys):
    assert main(words) == 2
    assert capsys.readouterr().err == f"{words[1]}: cannot be read: No such file or directory{hint}\n"
