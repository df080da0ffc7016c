"""The system file: read strictly, every error with its line."""

import re
from dataclasses import MISSING, replace
from pathlib import Path

import numpy as np
import pytest
from settings_page import ListedSetting, listed_settings, settings_page
from standing_obstacles import StandingObstacles

from gcs.campaign.toml_text import tables_text
from gcs.config import SystemConfig, UnusableFile, read_system
from gcs.config.overrides import with_settings
from gcs.config.tables import Cargo
from gcs.errors import UnusableInput
from gcs.flight import stack
from idc_controller.control.gain_schedule import ScheduledMpc

REPOSITORY = Path(__file__).parents[2]
EXAMPLE = REPOSITORY / "missions" / "system.toml"
TEXT = EXAMPLE.read_text()


def changed(tmp_path: Path, old: str, new: str) -> Path:
    assert old in TEXT
    path = tmp_path / "system.toml"
    path.write_text(TEXT.replace(old, new, 1))
    return path


def line_of(text: str) -> int:
    return TEXT[: TEXT.index(text)].count("\n") + 1


def test_example_file_has_the_default_values() -> None:
    assert read_system() == SystemConfig() == read_system(EXAMPLE)


def test_settings_page_is_up_to_date() -> None:
    assert (REPOSITORY / "docs" / "settings.md").read_text(encoding="utf-8") == settings_page(), "run make docs"


def test_partial_file_has_defaults_for_what_it_omits(tmp_path: Path) -> None:
    path = tmp_path / "system.toml"
    path.write_text("[controller.weights]\nlink_tilt = 70.0\n[team]\n")
    config, default = read_system(path), SystemConfig()
    assert config.controller.weights == replace(default.controller.weights, link_tilt=70.0)
    assert replace(config, controller=default.controller) == default


def test_settings_of_the_file_reach_estimator_guidance_filter_and_controller(tmp_path: Path) -> None:
    path = tmp_path / "system.toml"
    path.write_text(
        "[estimation.estimator]\nhistory = 0.7\n[estimation.wind]\nmemory = 7.0\n"
        "[safety.planner]\njerk = 0.003\n[safety.filter]\nwatch = 3.0\n[control.mpc]\nleast_lift = 0.9\n"
        "[avoidance]\nmargin = 0.6\n"
    )
    config = read_system(path)
    model = stack.linear_model(config)
    safety = stack.avoidance(config, model, StandingObstacles([]))
    controller = stack.controller(
        config, model, safety, lambda: 0.0, stack.guidance(config, model, StandingObstacles([]))
    )
    assert stack.estimator(config, model).settings.history == 0.7
    assert controller.load.wind.settings.memory == 7.0
    assert (safety.settings.jerk, safety.settings.margin, safety.filter_settings.watch) == (0.003, 0.6, 3.0)
    assert isinstance(controller.tracker, ScheduledMpc)
    assert [mpc.settings.least_lift for mpc in controller.tracker.by_age] == [0.9, 0.9]


def test_system_is_read_back_from_its_own_tables(tmp_path: Path) -> None:
    path = tmp_path / "system.toml"
    config = read_system(changed(tmp_path, "link_length = 3.2", "link_length = 3.1"))
    path.write_text(tables_text(config.tables()))
    assert read_system(path) == config


@pytest.mark.parametrize("listed", [*listed_settings()], ids=lambda listed: f"{listed.table}.{listed.key}")
def test_setting_outside_its_bounds_is_refused(tmp_path: Path, listed: ListedSetting) -> None:
    declared = listed.setting
    outside = []
    if (low := declared.gt if declared.gt is not None else declared.ge) is not None:
        outside.append(low - 1)
    if (high := declared.lt if declared.lt is not None else declared.le) is not None:
        outside.append(high + 1)
    for value in outside:
        value = type(declared_number(listed.default))(value)
        path = tmp_path / "system.toml"
        shown = [value] * len(listed.default) if isinstance(listed.default, tuple) else value
        path.write_text(f"[{listed.table}]\n{listed.key} = {shown}\n")
        name = re.sub(r"\[(\w+)\]", r"\1\\[1\\]", listed.table)  # of an array its first table
        with pytest.raises(UnusableFile) as caught:
            read_system(path)
        reason = rf"line 2: {name}\.{listed.key}.*: must be (greater|less)"
        assert any(re.search(reason, found) for found in caught.value.reasons), caught.value.reasons


def declared_number(default: object) -> object:
    if default is MISSING:
        return 0
    return default[0] if isinstance(default, tuple) else default


def test_default_parameters_are_those_of_the_paper() -> None:
    parameters = read_system().parameters()
    assert parameters.number_of_uavs == 4
    assert parameters.m_0 == 3.1
    corners = [[0.5, 0.5, -0.25], [0.5, -0.5, -0.25], [-0.5, -0.5, -0.25], [-0.5, 0.5, -0.25]]
    np.testing.assert_allclose(parameters.p, corners)
    np.testing.assert_allclose(parameters.l, 3.2)
    np.testing.assert_allclose(parameters.hover_thrust, (3.1 / 4 + 0.7) * 9.81)


@pytest.mark.parametrize("vehicles", [3, 5, 6, 8])
def test_with_vehicles_keeps_the_spacing(vehicles: int) -> None:
    parameters = read_system().with_vehicles(vehicles).parameters()
    assert parameters.number_of_uavs == vehicles
    np.testing.assert_allclose(np.linalg.norm(parameters.p - np.roll(parameters.p, 1, axis=0), axis=1), 1.0)


def test_with_vehicles_refuses_what_cannot_hover() -> None:
    with pytest.raises(UnusableInput, match="2 vehicles"):
        read_system().with_vehicles(2)


def test_attachments_replace_the_polygon(tmp_path: Path) -> None:
    layout = "attachments = [[0.5, 0.0, -0.25], [-0.5, 0.5, -0.25], [-0.5, -0.5, -0.25]]"
    config = read_system(changed(tmp_path, "vehicles = 4", f"vehicles = 3\n{layout}"))
    np.testing.assert_allclose(config.parameters().p[0], [0.5, 0.0, -0.25])
    assert config.with_vehicles(3) is config
    with pytest.raises(UnusableInput, match="attachments"):
        config.with_vehicles(4)


def test_payload_mass_factor_changes_the_world_only(tmp_path: Path) -> None:
    config = read_system(changed(tmp_path, "payload_mass_factor = 1.0", "payload_mass_factor = 1.1"))
    assert config.parameters().m_0 == 3.1
    assert config.true_parameters().m_0 == pytest.approx(3.41)


def test_noise_of_zero_is_accepted(tmp_path: Path) -> None:
    assert read_system(changed(tmp_path, "position = 0.02", "position = 0")).sensors.position == 0.0


@pytest.mark.parametrize(
    ("old", "new", "at", "reason"),
    [
        ("mass = 3.1 ", 'mass = "3.1" ', "mass = 3.1", "payload.mass: must be a valid number"),
        ("mass = 3.1 ", "mass = -3.1 ", "mass = 3.1", "payload.mass: must be greater than 0"),
        ("mass = 3.1 ", "mass = nan ", "mass = 3.1", "payload.mass: must be a finite number"),
        ("mass = 3.1 ", "mass = true ", "mass = 3.1", "payload.mass: must be a valid number"),
        ("mass = 3.1 ", "mass = ", "mass = 3.1", "not valid TOML"),
        ("mass = 3.1 ", "mass = 3.1\nmass = 3.1 ", "inertia = [0.29", "not valid TOML"),
        ("mass = 3.1 ", "mass = 3.1\ncolour = 1 ", "inertia = [0.29", "payload.colour: unknown key"),
        ("[world]", "[wind]\nspeed = 1.0\n[world]", "[world]", "wind: unknown key"),
        ("size = [1.0, 1.0, 0.5]", "size = [1.0, 1.0]", "size = ", "payload.size[3]: missing value"),
        ("vehicles = 4", "vehicles = 2", "vehicles = 4", "team.vehicles: "),
        ("vehicles = 4", "vehicles = 4\nattachments = [[0.5, 0.5, 0.0]]", "spacing = ", "1 points for 4 vehicles"),
        ("thrust_max = 30.0", "thrust_max = 10.0", "thrust_max = ", "uav.thrust_max: hover needs 14.5 N of one UAV"),
        (
            "mass = 3.1 ",
            "mass = 3100.0 ",
            "mass = 3.1",
            "payload.mass: hover needs 7609.6 N of one UAV (limit: less than its largest thrust, 30 N)",
        ),
        ("payload_mass_factor = 1.0", "payload_mass_factor = 9.0", "payload_mass_factor", "hover needs"),
        ("onboard = 250", "onboard = 240", "onboard =", "240 Hz does not divide physics"),
        ("control = 20", "control = 100", "control = 20", "100 Hz is faster than telemetry"),
        ("rate = 10 ", "rate = 30 ", "rate = 10", "range_sensor.rate: 30 Hz does not divide physics"),
        ("rate = 10 ", "rate = 100 ", "rate = 10", "range_sensor.rate: 100 Hz is faster than telemetry"),
        ("elevation_min_deg = -70.0 ", "elevation_min_deg = 31.0 ", "elevation_min_deg", "31.0 deg is not below"),
        ("physics = 500", "physics = 250", "physics = 500", "rates.physics: "),
        ("speed = 1.5 ", "speed = 4.0 ", "speed = 1.5", "motion.speed: 4.0 is more than speed_max"),
        ("position = [60.0, 60.0, 200.0]", "position = [60.0, -1.0, 80.0]", "position = [60", "position[2]: "),
        ("[controller.weights]", "[controller.weight]", "[controller.weights]", "controller.weight: unknown key"),
    ],
)
def test_wrong_file_is_refused_with_line_and_key(tmp_path: Path, old: str, new: str, at: str, reason: str) -> None:
    path = changed(tmp_path, old, new)
    with pytest.raises(UnusableFile) as caught:
        read_system(path)
    matching = [r for r in caught.value.reasons if reason in r]
    assert matching, caught.value.reasons
    assert matching[0].startswith(f"{path}: line {line_of(at)}: ")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("[safety.planner]\nlimit_interval = 100", "safety.planner: limit_interval 100 is longer than the horizon"),
        ("[safety.planner]\nblocks = []", "longer than the horizon, 0 stages"),
        ("[range_sensor]\nrange_min = 10.0", "line 2: range_sensor.range_min: 10.0 m is not below range, 10.0 m"),
        ("[range_sensor]\nelevation_min_deg = 40.0", "line 2: range_sensor.elevation_min_deg: 40.0 deg is not below"),
        ("[[cargo]]\nmass = 0.5", "line 1: cargo[1].gripper: missing key"),
        ("[[cargo]]\ngripper = 7\nmass = 0.5", "line 2: cargo[1].gripper: must be less than or equal to 6, found 7"),
        ("[[cargo]]\ngripper = 1\nmass = 0.0", "line 3: cargo[1].mass: must be greater than 0"),
        ("[[cargo]]\ngripper = 1\nmass = 0.5\nloaded = 1", "line 4: cargo[1].loaded: must be a valid boolean"),
        ("[[cargo]]\ngripper = 1\nmass = 1\n[[cargo]]\ngripper = 1\nmass = 1", "line 5: cargo[2].gripper: 1 is the"),
        (
            "[[cargo]]\ngripper = 1\nmass = 2\n[[cargo]]\ngripper = 2\nmass = 1.1",
            "line 6: cargo[2].mass: 1.1 kg: payload.mass, 3.1 kg, contains a container of 0.1 kg at least and 2 kg",
        ),
        ("[[cargo]]\ngripper = 1\nmass = 9\nloaded = false", "cargo: a payload of 12.1 kg with all that is not loaded"),
    ],
)
def test_settings_that_do_not_agree_are_refused(tmp_path: Path, text: str, reason: str) -> None:
    path = tmp_path / "system.toml"
    path.write_text(text + "\n")
    with pytest.raises(UnusableFile, match=re.escape(reason)):
        read_system(path)


def test_default_cargo_is_part_of_the_default_payload_only(tmp_path: Path) -> None:
    path = tmp_path / "system.toml"
    path.write_text("[payload]\nmass = 0.5\n")
    assert read_system(path).cargo == ()
    path.write_text("[avoidance]\nmargin = 0.4\n")
    assert read_system(path).cargo == SystemConfig().cargo
    assert with_settings(SystemConfig(), {"payload.mass": 0.5}).cargo == ()
    given = with_settings(SystemConfig(), {"cargo": [{"gripper": 3, "mass": 0.2, "loaded": False}]})
    assert given.cargo == (Cargo(3, 0.2, loaded=False),)
    without = with_settings(SystemConfig(), {"cargo": []})
    assert without.cargo == ()
    path.write_text(tables_text(without.tables()))
    assert read_system(path) == without


def test_file_with_several_errors_reports_every_reason(tmp_path: Path) -> None:
    with pytest.raises(UnusableFile) as caught:
        read_system(changed(tmp_path, "mass = 3.1 ", "mas = 3.1\nsze = 1 "))
    assert len(caught.value.reasons) == 2
    assert str(caught.value).endswith("(and 1 more)")


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"", "the file is empty"),
        (b"\xff\xfe[\x00", "not UTF-8 text"),
        (b"a = " + b"[" * 100_000, "nested too deeply"),
        (b"# " + b"x" * 9_000_000, "larger than"),
    ],
)
def test_unreadable_file_is_refused(tmp_path: Path, content: bytes, reason: str) -> None:
    path = tmp_path / "system.toml"
    path.write_bytes(content)
    with pytest.raises(UnusableFile, match=reason):
        read_system(path)


def test_missing_file_is_refused(tmp_path: Path) -> None:
    with pytest.raises(UnusableFile, match="cannot be read: No such file"):
        read_system(tmp_path / "none.toml")
    with pytest.raises(UnusableFile, match="is a folder"):
        read_system(tmp_path)


def test_system_is_frozen() -> None:
    config = read_system()
    with pytest.raises(AttributeError):
        config.team.vehicles = 5  # type: ignore[misc]
    assert hash(config) == hash(replace(config))
