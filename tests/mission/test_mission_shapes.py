"""Capsules, tilted boxes and meshes in mission files, in the physics engine and in the records."""

import math

import numpy as np
import pytest
import trimesh
from mission_files import TOML, description_of, read, refusal

from gcs.campaign.toml_text import mission_text
from gcs.mission.model import Limits
from gcs.record.obstacle_shapes import OBSTACLE_SHAPES, read_shape, write_shapes
from gcs.record.reader import read_json
from idc_controller.errors import ShapeError
from idc_controller.geometry.shapes import Box, Capsule, Mesh, MeshHull, Sphere

OBSTACLES = """
[[obstacle]]
name = "drum"
shape = "capsule"
position = [1.0, 2.0, -3.0]
radius = 0.4
length = 1.5
pitch_deg = 90.0

[[obstacle]]
name = "beam"
shape = "box"
position = [1.0, 2.0, -3.0]
size = [3.0, 0.2, 0.3]
roll_deg = 10.0
pitch_deg = 20.0
yaw_deg = 30.0
known = false
motion = { kind = "linear", velocity = [0.0, 0.0, -0.1] }

[[obstacle]]
name = "rock"
shape = "mesh"
file = "rock.ply"
position = [1.0, 2.0, -3.0]
scale = 0.5
"""
MESH = '\n[[obstacle]]\nname = "rock"\nshape = "mesh"\nposition = [1.0, 2.0, -3.0]\nfile = "{}"\n'


def hull_of(mesh, name="rock.ply"):
    corners = mesh.convex_hull.vertices - mesh.bounds.mean(axis=0)
    return MeshHull(name, tuple(map(tuple, corners.tolist())))


def wedge():
    """No symmetry about any axis, and its middle is not its origin."""
    return trimesh.convex.convex_hull(np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 3], [2, 1, 1.0]]))


@pytest.fixture
def mission(tmp_path):
    wedge().export(tmp_path / "rock.ply")
    return read(tmp_path, TOML + OBSTACLES, "mission.toml")


def test_mission_reads_shapes_in_any_attitude(mission):
    drum, beam, rock = mission.obstacles[2:]
    assert drum.shape == Capsule(0.4, 1.5, pitch=math.pi / 2) and drum.known
    angles = {"roll": math.radians(10.0), "pitch": math.radians(20.0), "yaw": math.radians(30.0)}
    assert beam.shape == Box((3.0, 0.2, 0.3), **angles) and not beam.known and beam.motion is not None
    np.testing.assert_allclose(np.ptp(rock.shape.corners, axis=0), [1.0, 0.5, 1.5])
    np.testing.assert_allclose(rock.shape.corners.min(axis=0), -rock.shape.corners.max(axis=0))
    text = description_of(mission)
    assert "capsule 'drum' at [1.0, 2.0, -3.0], radius 0.4 m, 1.5 m between its round ends, pitch 90.0 deg" in text
    assert (
        "box 'beam' at [1.0, 2.0, -3.0], 3 x 0.2 x 0.3 m, roll 10.0 deg, pitch 20.0 deg, yaw 30.0 deg, not on" in text
    )
    assert "mesh 'rock' at [1.0, 2.0, -3.0], rock.ply, 1 x 0.5 x 1.5 m" in text


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply"])
def test_mission_reads_meshes_of_every_format(tmp_path, suffix):
    wedge().export(tmp_path / f"rock.{suffix}")
    mission = read(tmp_path, TOML + MESH.format(f"rock.{suffix}"), "mission.toml")
    assert len(mission.obstacles[2].shape.corners) == 5


def concave(path):
    outline = [[0, 0], [2, 0], [2, 0.4], [0.4, 0.4], [0.4, 2], [0, 2]]
    points = np.array([[*p, z] for z in (0.0, 1.0) for p in outline])
    sides = [f for i in range(6) for j in [(i + 1) % 6] for f in ([i, j, j + 6], [i, j + 6, i + 6])]
    lids = [[0, 3, 1], [1, 3, 2], [0, 5, 4], [0, 4, 3]]
    faces = [*sides, *lids, *([a + 6, c + 6, b + 6] for a, b, c in lids)]
    trimesh.Trimesh(points, faces).export(path)


def with_hole(path):
    mesh = wedge()
    trimesh.Trimesh(mesh.vertices, mesh.faces[1:]).export(path)


def flat(path):
    trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).export(path)


@pytest.mark.parametrize(
    ("make", "name", "reason"),
    [
        (lambda path: None, "rock.stl", "cannot read 'rock.stl': No such file"),
        (lambda path: path.write_bytes(b""), "rock.stl", "'rock.stl'"),
        (lambda path: path.write_text("solid\nfacet nonsense\n"), "rock.stl", "'rock.stl'"),
        (lambda path: path.write_text("# nothing\n"), "rock.obj", "'rock.obj'"),
        (lambda path: path.write_text("ply\nformat ascii 9\n"), "rock.ply", "'rock.ply'"),
        (lambda path: path.mkdir(), "rock.stl", "cannot read 'rock.stl'"),
        (lambda path: path.write_text("?"), "rock.step", "'rock.step' is none of .stl, .obj, .ply"),
        (flat, "rock.stl", "'rock.stl' is flat: its bounding box is 1 x 1 x 0"),
        (with_hole, "rock.stl", "'rock.stl' is not watertight: its surface has holes; close it"),
        (concave, "rock.stl", "'rock.stl' is concave: it fills 53 % of its convex hull (limit 95 %); cut it"),
    ],
)
def test_unusable_mesh_is_refused_with_file_line_field_and_reason(tmp_path, make, name, reason):
    make(tmp_path / name)
    content = TOML + MESH.format(name)
    reasons = refusal(tmp_path, content, "mission.toml")
    line = content.splitlines().index(f'file = "{name}"') + 1
    assert len(reasons) == 1
    assert reasons[0].startswith(f"{tmp_path / 'mission.toml'}: line {line}: obstacle[3].file: ")
    assert reason in reasons[0]


def test_missing_unknown_and_wrong_keys_of_shapes_are_refused(tmp_path):
    for shape, line, reason in (
        ("capsule", "radius = 1.0", "length: missing key"),
        ("capsule", "radius = 1.0\nlength = 0.0", "length: must be greater than 0"),
        ("box", "size = [1.0, 1.0, 1.0]\ntilt_deg = 3.0", "tilt_deg: unknown key"),
        ("mesh", "scale = 1.0", "file: missing key"),
        ("cone", "radius = 1.0", "'cone' is none of 'sphere', 'pole', 'wall', 'capsule', 'box', 'mesh'"),
    ):
        table = f'\n[[obstacle]]\nname = "x"\nshape = "{shape}"\nposition = [1.0, 2.0, -3.0]\n{line}\n'
        reasons = refusal(tmp_path, TOML + table, "mission.toml")
        assert any(reason in r for r in reasons), reasons


def test_written_mission_is_read_back_the_same(mission, tmp_path):
    text = mission_text("again", 1, mission.reference, mission.obstacles, Limits())
    assert read(tmp_path, text, "mission.toml").obstacles == mission.obstacles


SHAPES = [
    Capsule(0.3, 1.5, roll=0.4, pitch=-0.7, yaw=2.0), Box((0.5, 1.0, 2.0), roll=0.3, pitch=0.5, yaw=-1.0),
    Mesh(hull_of(wedge()), scale=0.6, roll=0.4, pitch=0.5, yaw=1.0),
]  # fmt: skip


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: shape.kind)
def test_record_gives_the_shape_and_its_clearance_back(shape, tmp_path):
    write_shapes(tmp_path, {"x": shape, "ball": Sphere(1.0)})
    fields = read_json(tmp_path / OBSTACLE_SHAPES)
    assert read_shape(shape.kind, shape.columns, fields["x"]) == shape
    assert "ball" not in fields and read_shape("sphere", Sphere(1.0).columns, None) == Sphere(1.0)
    with pytest.raises(ShapeError, match=r"needs the run's obstacle_shapes\.json"):
        read_shape(shape.kind, shape.columns, None)
    with pytest.raises(ShapeError, match=r"obstacle_shapes\.json does not hold the"):
        read_shape(shape.kind, shape.columns, {"edges": 1.0})
    with pytest.raises(ShapeError, match="shape is 'cone', expected one of sphere"):
        read_shape("cone", shape.columns, None)


def test_columns_hold_the_bounding_box():
    upright = Capsule(0.3, 1.0)
    assert upright.columns == (0.3, pytest.approx((0.6, 0.6, 1.6)), 0.0)
    lying = Capsule(0.3, 1.0, pitch=math.pi / 2)
    assert lying.columns == (0.3, pytest.approx((1.6, 0.6, 0.6)), 0.0)


def test_no_file_of_shapes_where_the_columns_suffice(tmp_path):
    write_shapes(tmp_path, {"ball": Sphere(1.0)})
    assert not (tmp_path / OBSTACLE_SHAPES).exists()
