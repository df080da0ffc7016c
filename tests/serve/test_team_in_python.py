"""``gcs.Team``: a team that takes orders from Python."""

from __future__ import annotations

import math
import runpy
from functools import partial
from pathlib import Path

import pytest
from flights import truth_of
from programs import process
from virtual_time import GROUND, WORLD, VirtualTime, run_ground, swarm_in_real_time

import gcs
from gcs.app import team as team_module
from gcs.drivers.connection import Connection
from gcs.errors import GcsError
from gcs.mission.read import read_mission
from gcs.serve.server import TeamServer

pytestmark = pytest.mark.slow
FEW = {"team.vehicles": 3}


def short(folder: Path) -> gcs.Team:
    return gcs.Team.simulate(seed=3, settings=FEW, run_dir=folder)


def test_orders_are_carried_out_and_refusals_raise(tmp_path: Path) -> None:
    with short(tmp_path / "run") as team:
        with pytest.raises(gcs.OrderRefused, match="Reposition denied: not in the air"):
            team.go_to(1, 1, 2)
        with pytest.raises(gcs.OrderRefused, match="Mission denied: no mission"):
            team.start()
        team.upload("missions/square.waypoints")
        team.start()
        while team.position[0] < 1.5:
            team.run(0.5)
        team.pause()
        assert team.wait() and team.speed < 0.1
        with pytest.raises(gcs.OrderRefused, match="Takeoff denied: it has taken off already"):
            team.take_off()
        team.go_to(1.0, 1.0, 2.0)
        assert team.wait() and team.position == pytest.approx((1.0, 1.0, 2.0), abs=0.05)
        team.change_speed(0.5)
        team.resume()
        team.run(4.0)
        assert team.phase == "fly" and 0.3 < team.speed < 0.6
        team.land()
        first = team.finish()
        assert first is not None and first.outcome == "completed" and first.figures["contacts"] == 0
        team.take_off(1.5)
        assert team.wait() and team.in_air
        team.return_home()
        second = team.finish()
        assert [flight.outcome for flight in team.flights] == ["completed", "completed"]
        assert second is not None and abs(second.truth["payload_x_m"][-1]) < 0.2
        assert team.position == pytest.approx((0.0, 0.0, 0.3), abs=0.1), "not measured anew yet"
        assert team.finish() is None, "none flies"


def test_same_orders_give_the_same_bytes_and_leaving_lands(tmp_path: Path) -> None:
    for number in ("a", "b"):
        with short(tmp_path / number) as team:
            team.take_off(1.0)
            team.wait()
        assert not team.in_air
    for name in ("truth.csv", "flight-1/estimate.csv", "flight-1/truth.csv"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()


def test_example_of_the_documents_runs(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    example = Path(__file__).parents[2] / "docs/examples/team_from_python.py"
    monkeypatch.chdir(example.parents[2])
    runpy.run_path(str(example), run_name="__main__")
    assert "completed" in capsys.readouterr().out


def test_team_connects_to_a_running_swarm(tmp_path: Path) -> None:
    world = read_mission("hover", None, FEW)
    with process("--vehicles", "3", "--ground-port", "0", "--base-port", "0", "--run-dir", tmp_path / "world") as swarm:
        urls = [f"udp://{host}:{port}" for host, port in swarm[2]]
        with gcs.Team.connect(*urls, world=world, run_dir=tmp_path / "run") as team:
            assert team._drive.run(lambda: not math.isnan(team.position[0]), 120.0)
            assert team.position == pytest.approx((0.0, 0.0, 0.3), abs=0.1)
            with pytest.raises(gcs.OrderRefused, match="Land denied: not in the air"):
                team.land()
            assert not team.in_air and team.flights == []


@pytest.mark.long
def test_team_flies_a_swarm_in_real_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    world, time = read_mission("hover", None, FEW), VirtualTime([WORLD, GROUND])
    monkeypatch.setattr(team_module, "run_in_real_time", partial(run_ground, time))
    monkeypatch.setattr(Connection, "wait", lambda self, timeout: time.wait(GROUND, [self.socket], timeout))
    with swarm_in_real_time(time, world, tmp_path / "world") as vehicles:
        urls = [f"udp://{host}:{port}" for host, port in vehicles]
        with gcs.Team.connect(*urls, world=world, run_dir=tmp_path / "run") as team:
            team.take_off(1.5)
            assert team.wait() and team.in_air
            team.go_to(2.0, 1.0, 2.0)
            assert team.wait() and team.position == pytest.approx((2.0, 1.0, 2.0), abs=0.05)
            team.land()
            flight = team.finish()
            assert flight is not None and flight.outcome == "completed", flight
            team.take_off(1.0)
            assert team.wait() and team.in_air
        assert not team.in_air and [each.outcome for each in team.flights] == ["completed", "interrupted"]
    truth = truth_of(tmp_path / "world")
    end = {axis: truth[f"payload_{axis}_m"][-1] for axis in "xyz"}
    assert end == pytest.approx({"x": 2.0, "y": 1.0, "z": -0.25}, abs=0.1)
    assert truth["contacts"].max() == 0 and max(truth[f"uav{i}_thrust_n"][-1] for i in (1, 2, 3)) < 0.5


def test_ground_that_fails_is_reported_by_the_next_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(TeamServer, "datagrams_to_send", lambda self, now: 1 / 0)
    with (
        pytest.raises(GcsError, match="the ground has ended: division by zero"),
        gcs.Team.connect(run_dir=tmp_path / "run") as team,
    ):
        team.land()
