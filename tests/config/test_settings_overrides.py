"""Settings by dotted path in place of a system file's: ``gcs.fly(settings=...)``."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from gcs.app.fly import simulator_arguments
from gcs.app.fly_options import FlyOptions, prepare
from gcs.config import SystemConfig, read_system
from gcs.config.overrides import with_settings
from gcs.errors import UnusableInput
from gcs.mission.read import read_mission
from vehicle_sim.app.arguments import parse

MISSIONS = Path(__file__).parents[2] / "missions"


def test_values_take_the_place_of_the_systems_own():
    system = SystemConfig()
    changed = with_settings(
        system, {"avoidance.margin": np.float64(0.4), "avoidance.barrier_rates": np.array([6.0, 6.0]),
                 "team.vehicles": np.int64(5), "world.pad.margin": 0.2}
    )  # fmt: skip
    assert (changed.avoidance.margin, changed.avoidance.barrier_rates) == (0.4, (6.0, 6.0))
    assert changed.team.vehicles == 5 and changed.world.pad.margin == 0.2
    kept = {name: getattr(changed, name) for name in ("avoidance", "team", "world")}
    assert replace(system, **kept) == changed
    assert with_settings(system, {}) == system == with_settings(changed, {
        "avoidance.margin": system.avoidance.margin, "avoidance.barrier_rates": list(system.avoidance.barrier_rates),
        "team.vehicles": 4, "world.pad.margin": system.world.pad.margin,
    })  # fmt: skip


def test_mesh_of_a_payload_is_kept_given_and_taken_away(monkeypatch):
    system = read_system(MISSIONS / "l_payload.toml")
    kept = with_settings(system, {"avoidance.margin": 0.4})
    np.testing.assert_array_equal(kept.payload.hull.vertices, system.payload.hull.vertices)
    monkeypatch.chdir(MISSIONS)
    with pytest.raises(UnusableInput) as refused:
        with_settings(SystemConfig(), {"payload.mesh": "l_beam.obj"})
    assert "settings: payload.size: follows from mesh: leave it out" in refused.value.reasons
    with_mesh = {"payload.mesh": "l_beam.obj", "payload.size": None, "payload.inertia": None}
    attachments = [list(point) for point in system.team.attachments]
    changed = with_settings(SystemConfig(), {**with_mesh, "team.attachments": attachments})
    np.testing.assert_array_equal(changed.payload.hull.vertices, system.payload.hull.vertices)
    box = {"payload.mesh": None, "payload.size": [1.0, 1.0, 0.5], "team.attachments": None}
    assert with_settings(system, {**box, "payload.inertia": [1.0, 1.0, 1.0]}).payload.mesh is None


@pytest.mark.parametrize(
    ("path", "hint"),
    [
        ("avoidance.margn", ": did you mean 'avoidance.margin'?"),
        ("payload_mass_factor", ": did you mean 'world.payload_mass_factor'?"),
        ("sensor.payload_rates", ": did you mean 'sensors.payload_rates'?"),
        ("qqq", ": docs/settings.md lists all"),
        ("avoidance", ""),
    ],
)
def test_path_of_no_setting_is_refused_with_the_nearest(path, hint):
    with pytest.raises(UnusableInput) as refused:
        with_settings(SystemConfig(), {path: 1.0})
    assert str(refused.value).startswith(f"settings: there is no '{path}'{hint}")


def test_route_is_made_for_the_changed_system():
    assert read_mission(MISSIONS / "square.waypoints").reference.speed == SystemConfig().motion.speed
    assert read_mission(MISSIONS / "square.waypoints", settings={"motion.speed": 1.25}).reference.speed == 1.25


@pytest.mark.parametrize(
    ("path", "value", "reason"),
    [
        ("perception.retention.delete_after", 0.0, "must be greater than 0, found 0.0"),
        ("perception.standing_map.hit_share_min", 1.5, "must be less than 1, found 1.5"),
        ("perception.association.merge_frames", 2.5, "must be a valid integer, found 2.5"),
        ("perception.tracking.motion.frequencies", 1.0, "must be a valid array, found 1.0"),
    ],
)
def test_plain_default_is_held_to_type_and_sign(path, value, reason):
    with pytest.raises(UnusableInput, match=rf"^settings: {path}.*: {reason}"):
        with_settings(SystemConfig(), {path: value})


def test_plain_default_is_set_by_its_path_and_in_a_system_file(tmp_path):
    (tmp_path / "system.toml").write_text("[perception.retention]\ndelete_after = 2\n")
    changed = with_settings(SystemConfig(), {"perception.retention.delete_after": 2.0})
    assert changed == read_system(tmp_path / "system.toml") != SystemConfig()
    assert changed.perception.retention.delete_after == 2.0


def test_simulator_of_a_flight_has_its_settings(tmp_path):
    given = {"payload.mesh": "a b.obj", "world.payload_mass_factor": 1.1, "avoidance.barrier_rates": [6.0, 6.0]}
    mission = prepare(FlyOptions(MISSIONS / "hop.toml"))
    options = FlyOptions(MISSIONS / "hop.toml", settings=given)
    assert parse(simulator_arguments(options, mission, tmp_path)).settings == given
