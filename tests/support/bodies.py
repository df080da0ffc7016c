"""Bodies of every shape, for tests."""

import numpy as np

from idc_controller.geometry.shapes import Box, Capsule, Mesh, MeshHull, Pole, Sphere, Wall

ROCK = MeshHull("rock.stl", ((-1.0, -0.6, 0.5), (0.9, -0.7, 0.5), (1.0, 0.8, 0.5), (-0.8, 0.7, 0.4), (0.1, 0.0, -0.5)))
EXAMPLES = [
    Sphere(0.6), Pole(0.3, 4.0), Wall((0.4, 3.0, 2.0), 0.4), Capsule(0.3, 1.5, roll=0.4, pitch=-0.7, yaw=2.0),
    Box((0.5, 1.0, 2.0), roll=0.3, pitch=0.5, yaw=-1.0), Mesh(ROCK, scale=1.2, roll=0.1, pitch=0.5, yaw=1.0),
]  # fmt: skip


def random_shape(rng, kind=None):
    angles = dict(zip(("roll", "pitch", "yaw"), rng.uniform(-3.0, 3.0, 3), strict=True))
    size = tuple(rng.uniform(0.2, 4.0, 3))
    return {
        0: lambda: Sphere(rng.uniform(0.1, 1.5)),
        1: lambda: Pole(rng.uniform(0.05, 0.6), rng.uniform(1.0, 15.0)),
        2: lambda: Wall(size, rng.uniform(-3.0, 3.0)),
        3: lambda: Capsule(rng.uniform(0.1, 0.5), rng.uniform(0.5, 6.0), **angles),
        4: lambda: Box(size, **angles),
        5: lambda: Mesh(ROCK, scale=rng.uniform(0.3, 2.0), **angles),
    }[rng.integers(6) if kind is None else kind]()


def random_scene(seed, count, kind=None, high=-50.0, nearest=1.0):
    """Bodies about a place that is in none of them."""
    rng, scene = np.random.default_rng(seed), []
    while len(scene) < count:
        shape, offset = random_shape(rng, kind), rng.normal(0.0, 4.0, 3)
        if np.linalg.norm(offset) > shape.reach + nearest:
            scene.append((shape, (offset[0], offset[1], offset[2] + high)))
    return scene
