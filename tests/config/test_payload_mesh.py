"""The payload from a mesh: mass properties, attachment, and every part that depends on its shape."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import trimesh
from avoidance_scene import hull_of
from nonlinear_motion import hover_inputs, hover_state
from plain_flatness import flat_forces
from scipy.spatial import Delaunay

from gcs.campaign.faults.base_mission import read_base
from gcs.config import SystemConfig, UnusableFile, read_system
from gcs.errors import UnusableInput
from gcs.record.run_data import read_run
from gcs.record.run_folder import write_manifest
from idc_controller.errors import ParameterError
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.free_space import BoundingCylinder
from idc_controller.model.nonlinear import accelerations
from idc_controller.parameters import PayloadHull
from idc_controller.trajectory.flatness import Load
from vehicle_sim.world.multibody import principal_axes
from vehicle_sim.world.world import World

MISSIONS = Path(__file__).parents[2] / "missions"
L_SYSTEM = MISSIONS / "l_payload.toml"


def system_of(
    folder: Path, mesh: trimesh.Trimesh | None, team: str = "", name: str = "body.ply", payload: str = ""
) -> Path:
    """A system file with this mesh beside it."""
    if mesh is not None:
        mesh.export(folder / name)
    path = folder / "system.toml"
    path.write_text(f'[payload]\nmesh = "{name}"\n{payload}\n[team]\n{team}\n')
    return path


def wedge() -> trimesh.Trimesh:
    """A body without symmetry: all products of inertia differ from zero."""
    corners = [
        [-0.7, -0.6, -0.2],
        [0.6, -0.7, -0.2],
        [0.7, 0.6, -0.2],
        [-0.6, 0.6, -0.2],
        [0.5, -0.4, 0.3],
        [0.3, 0.5, 0.4],
    ]
    return trimesh.convex.convex_hull(np.array(corners))


def wedge_system(folder: Path) -> SystemConfig:
    points = "[[0.6, 0.5, -0.2], [0.5, -0.6, -0.2], [-0.6, -0.5, -0.2], [-0.5, 0.5, -0.2]]"
    return read_system(system_of(folder, wedge(), f"attachments = {points}"))


def test_mass_properties_of_the_l_are_those_of_its_two_boxes() -> None:
    payload = read_system(L_SYSTEM).payload
    assert payload.mesh is not None
    centre = np.array([-0.06, -0.08, 0.0])
    parts = [((1.2, 0.8, 0.3), (0.0, -0.2, 0.0)), ((0.6, 0.4, 0.3), (-0.3, 0.4, 0.0))]
    inertia = np.zeros((3, 3))
    for size, middle in parts:
        mass = 3.1 * np.prod(size) / 0.36
        about = np.square(size).sum() * np.eye(3) - np.diag(np.square(size))
        offset = np.subtract(middle, centre)
        inertia += mass * (about / 12.0 + (offset @ offset) * np.eye(3) - np.outer(offset, offset))
    assert payload.mesh.volume == pytest.approx(0.36)
    np.testing.assert_allclose(payload.centre_of_mass, centre, atol=1e-12)
    np.testing.assert_allclose(payload.inertia_tensor, inertia, atol=1e-12)
    assert abs(inertia[0, 1]) > 0.08
    assert payload.hull.below == pytest.approx(0.15)
    assert payload.size is None and payload.inertia is None


@pytest.mark.parametrize("name", ["body.stl", "body.obj", "body.ply"])
def test_payload_depends_neither_on_format_nor_on_origin_of_the_file(tmp_path: Path, name: str) -> None:
    mesh = wedge()
    expected = wedge_system(tmp_path).parameters()
    shift = np.array([300.0, -200.0, 50.0]) if name == "body.ply" else np.zeros(3)
    mesh.apply_translation(shift)
    points = (expected.p + wedge().center_mass + shift).tolist()
    found = read_system(system_of(tmp_path, mesh, f"attachments = {points}", name)).parameters()
    np.testing.assert_allclose(found.J_0, expected.J_0, atol=1e-4)
    np.testing.assert_allclose(found.p, expected.p, atol=1e-4)
    np.testing.assert_allclose(found.payload.bounds, expected.payload.bounds, atol=1e-4)


def test_mesh_of_a_box_is_the_box(tmp_path: Path) -> None:
    found = read_system(system_of(tmp_path, trimesh.creation.box((1.0, 1.0, 0.5)))).parameters()
    expected = SystemConfig().parameters()
    np.testing.assert_allclose(found.p, expected.p, atol=1e-9)
    np.testing.assert_allclose(found.payload.areas, expected.payload.areas, atol=1e-9)
    assert found.payload.box_edges == pytest.approx([1.0, 1.0, 0.5])


def test_hover_of_asymmetric_payload_is_an_equilibrium(tmp_path: Path) -> None:
    for parameters in (read_system(L_SYSTEM).parameters(), wedge_system(tmp_path).parameters()):
        found = accelerations(parameters, hover_state(parameters), hover_inputs(parameters))
        np.testing.assert_allclose(np.concatenate([part.ravel() for part in found]), 0.0, atol=1e-9)
        assert np.ptp(parameters.hover_thrust) > 0.5
        forces = flat_forces(parameters, np.zeros((5, 1, 3)), Load(parameters.m_0, np.zeros(3)))
        np.testing.assert_allclose(-forces.force[0, :, 2], parameters.hover_thrust, rtol=1e-12)


def test_principal_axes_of_a_diagonal_tensor_are_the_axes_of_its_frame() -> None:
    moments, axes = principal_axes(np.diag([0.5, 0.2, 0.35]))
    assert moments.tolist() == [0.5, 0.2, 0.35]
    assert axes.tolist() == np.eye(3).tolist()


def test_payload_of_a_mesh_stands_level_on_its_pad(tmp_path: Path) -> None:
    for parameters in (read_system(L_SYSTEM).parameters(), wedge_system(tmp_path).parameters()):
        with World(parameters) as world:
            for _ in range(500):
                world.step([0.0] * 4, [(0.0, 0.0, 0.0)] * 4)
            state, contacts = world.state(), world.contacts()
        assert contacts.pairs == 0
        assert state.payload_position_in_world == pytest.approx((0.0, 0.0, -0.05 - parameters.payload.below), abs=3e-3)
        assert abs(state.payload_quaternion[0]) == pytest.approx(1.0, abs=1e-5)


@pytest.mark.parametrize("subdivisions", [0, 2])
def test_hulls_for_planning_hold_the_mesh(tmp_path: Path, subdivisions: int) -> None:
    ball = trimesh.creation.icosphere(subdivisions=subdivisions, radius=0.6)
    centres = ball.triangles_center
    directions = [[np.cos(angle), np.sin(angle), -0.5] for angle in (0.8, -0.8, -2.4, 2.4)]
    points = [centres[np.argmax(centres @ direction)].tolist() for direction in directions]
    parameters = read_system(system_of(tmp_path, ball, f"attachments = {points}")).parameters()
    formation = Formation(parameters)
    hull = formation.hull_points(np.zeros((1, 3)))[0]
    assert len(hull) <= 32
    assert (Delaunay(hull).find_simplex(0.999 * parameters.payload.vertices) >= 0).all()
    cylinder = BoundingCylinder.of(parameters)
    exact = hull_of(parameters, np.zeros((5, 1, 3)))[0]
    assert np.hypot(exact[:, 0], exact[:, 1]).max() <= cylinder.radius + 1e-9
    assert (-cylinder.above - 1e-9 <= exact[:, 2].min()) and (exact[:, 2].max() <= cylinder.below + 1e-9)
    normals = np.random.default_rng(1).normal(size=(50, 3))
    np.testing.assert_allclose(
        (normals @ parameters.payload.vertices.T).max(axis=1), (normals @ ball.vertices.T).max(axis=1), rtol=1e-5
    )


def open_box() -> trimesh.Trimesh:
    box = trimesh.creation.box((1.0, 1.0, 0.5))
    return trimesh.Trimesh(box.vertices, box.faces[1:], process=False)


def flipped_face() -> trimesh.Trimesh:
    box = trimesh.creation.box((1.0, 1.0, 0.5))
    faces = box.faces.copy()
    faces[0] = faces[0, ::-1]
    return trimesh.Trimesh(box.vertices, faces, process=False)


def overlapping_boxes() -> trimesh.Trimesh:
    boxes = [trimesh.creation.box((1.0, 1.0, 0.5)) for _ in range(2)]
    boxes[1].apply_translation((0.5, 0.0, 0.0))
    return trimesh.util.concatenate(boxes)


@pytest.mark.parametrize(
    ("mesh", "team", "name", "payload", "key", "reason"),
    [
        (None, "", "absent.stl", "", "payload.mesh", "cannot read 'absent.stl'"),
        (None, "", "", "", "payload.mesh", "at least 1 character"),
        (trimesh.creation.box((1, 1, 0.5)), "", "body.glb", "", "payload.mesh", "'body.glb' is none of"),
        (flipped_face(), "", "body.ply", "", "payload.mesh", "faces are not all oriented outwards"),
        (open_box(), "", "body.ply", "", "payload.mesh", "not watertight"),
        (trimesh.creation.box((1, 1, 1e-9)), "", "body.ply", "", "payload.mesh", "is flat"),
        (trimesh.creation.box((1000, 1000, 500)), "", "body.ply", "", "payload.mesh", "1e+03 x 1e+03 x 500 m (limit"),
        (trimesh.creation.box((0.01, 0.01, 0.01)), "", "body.ply", "", "payload.mesh", "0.01 x 0.01 x 0.01 m (limit"),
        (trimesh.creation.icosphere(5), "", "body.ply", "", "payload.mesh", "corners (limit 2000)"),
        (overlapping_boxes(), "", "body.ply", "", "payload.mesh", "has 2 closed surfaces (limit 1)"),
        (trimesh.creation.box((1, 1, 0.5)), "attachments = []", "body.ply", "", "team.attachments", "0 points for 4"),
        (wedge(), "", "body.ply", "size = [1.0, 1.0, 0.5]", "payload.size", "follows from mesh"),
        (wedge(), "", "body.ply", "inertia = [0.3, 0.3, 0.5]", "payload.inertia", "follows from mesh"),
        (trimesh.creation.icosphere(3, 0.8), "", "body.ply", "", "team.attachments",
         "point 1 at [0.500, 0.500, -0.800] m is"),
        (trimesh.creation.box((1.4, 1.4, 0.3)),
         "attachments = [[0.5, 0.5, -0.15], [0.5, -0.5, -0.15], [-0.5, -0.5, -0.15], [-0.5, 0.5, -0.25]]", "body.ply",
         "", "team.attachments", "point 4 at [-0.500, 0.500, -0.250] m is 0.100 m off the surface of 'body.ply' "
         "(limit 0.005 m); the nearest point on it is [-0.500, 0.500, -0.150] m"),
        (trimesh.creation.box((1.4, 1.4, 0.3)),
         "attachments = [[0.5, 0.5, -0.15], [0.5, -0.5, -0.15], [0.1, -0.5, -0.15], [0.1, 0.5, -0.15]]", "body.ply", "",
         "team", "would bear -12.5 % of the payload's weight"),
    ],
    ids=lambda value: value if isinstance(value, str) and 0 < len(value) < 30 else "",
)  # fmt: skip
def test_unusable_payload_is_refused_with_line_and_key(
    tmp_path: Path, mesh: trimesh.Trimesh | None, team: str, name: str, payload: str, key: str, reason: str
) -> None:
    path = system_of(tmp_path, mesh, team, name, payload)
    with pytest.raises(UnusableFile) as caught:
        read_system(path)
    matching = [line for line in caught.value.reasons if f": {key}: " in line and reason in line]
    assert matching, caught.value.reasons
    assert matching[0].startswith(f"{path}: line ")


def test_another_number_of_vehicles_is_refused_where_the_polygon_misses_the_mesh(tmp_path: Path) -> None:
    config = read_system(system_of(tmp_path, trimesh.creation.box((1.2, 1.2, 0.3))))
    assert config.with_vehicles(3).parameters().number_of_uavs == 3
    with pytest.raises(UnusableInput, match=r"8 vehicles: point 1 at .* off the surface"):
        config.with_vehicles(8)


def test_mesh_keeps_its_name_in_the_tables_of_the_system(tmp_path: Path) -> None:
    (tmp_path / "parts").mkdir()
    system = read_system(system_of(tmp_path, trimesh.creation.box((1.2, 1.2, 0.3)), name="parts/body.ply"))
    assert system.tables()["payload"]["mesh"] == "parts/body.ply"


def test_run_records_the_hull_of_the_payload(tmp_path: Path) -> None:
    for config in (
        read_system(L_SYSTEM),
        replace(SystemConfig(), payload=replace(SystemConfig().payload, size=(1.0, 2.0, 0.4))),
    ):
        write_manifest(tmp_path, command=[], seed=1, mission=None, system=config, start="")
        np.testing.assert_array_equal(read_run(tmp_path).payload.vertices, config.payload.hull.vertices)
    assert "surface" not in json.loads((tmp_path / "manifest.json").read_text())["system"]["payload"]


def test_mission_copied_for_a_campaign_takes_its_payload_along(tmp_path: Path) -> None:
    base = read_base(MISSIONS / "l_payload_course.toml")
    for file, text in base.files.items():
        (tmp_path / file).write_text(text, encoding="utf-8")
    copied = read_system(tmp_path / base.tables["mission"]["system"]).parameters()
    np.testing.assert_allclose(copied.J_0, read_system(L_SYSTEM).parameters().J_0, rtol=1e-12)
    np.testing.assert_allclose(copied.p, read_system(L_SYSTEM).parameters().p, rtol=1e-12)


def test_payload_hull_refuses_vertices_beside_the_centre_of_mass() -> None:
    with pytest.raises(ParameterError, match="must enclose its centre of mass"):
        PayloadHull(PayloadHull.box((1.0, 1.0, 1.0)).vertices + 0.6)
