"""The safety filter flown kinematically through random scenes."""

import numpy as np
import pytest
from avoidance_checks import MARGIN, TOLERANCE, check_arrived, check_smooth
from avoidance_scene import (
    avoidance,
    fly,
    pole,
    sphere,
    straight,
    swinging,
    wall,
)  # fmt: skip


def random_scene(rng):
    """Obstacles about a path of 20 m, none at its ends; moving ones slow enough to be detected in time."""
    obstacles = []
    for i in range(rng.integers(1, 4)):
        north, east = rng.uniform(5.5, 14.0), rng.uniform(-2.5, 2.5)
        kind = rng.choice(["sphere", "moving", "swinging", "pole", "wall"])
        name = f"{kind} {i}"
        if kind == "sphere":
            obstacles.append(sphere(name, (north, east, rng.uniform(-8.5, -4.0)), radius=rng.uniform(0.3, 0.7)))
        elif kind == "moving":
            heading, speed = rng.uniform(0.0, 2.0 * np.pi), rng.uniform(0.3, 1.0)
            velocity = speed * np.array([np.cos(heading), np.sin(heading), 0.0])
            meets = rng.uniform(5.0, 9.0)
            place = np.array([north, east, rng.uniform(-8.0, -4.5)]) - meets * velocity
            if np.linalg.norm(place[:2]) > 3.5:
                obstacles.append(sphere(name, place, velocity))
        elif kind == "swinging":
            swing = rng.uniform(-1.2, 1.2, 3) * [1.0, 1.0, 0.3]
            obstacles.append(swinging(name, (north, east, -5.5), swing, 0.8, rng.uniform(0.0, 6.0)))
        elif kind == "pole":
            obstacles.append(pole(name, north, east, rng.uniform(0.15, 0.4)))
        else:
            size = (0.3, rng.uniform(1.0, 4.0), rng.uniform(2.0, 13.0))
            obstacles.append(wall(name, north, east, size, rng.uniform(-0.6, 0.6)))
    return obstacles


@pytest.mark.slow
@pytest.mark.parametrize("seed", [pytest.param(seed, marks=[pytest.mark.long] * (seed >= 6)) for seed in range(20)])
def test_random_scene_is_never_entered(seed):
    rng = np.random.default_rng([seed, 5])
    obstacles = random_scene(rng)
    flown = fly(avoidance(obstacles), straight(20.0), 45.0)
    # What the filter says of its slack is what it costs at most.
    assert min(flown.clearance(every=3).values(), default=np.inf) >= MARGIN - TOLERANCE - flown.slack
    assert flown.slack < 0.15
    check_smooth(flown, crackle=250.0)
    if not any("moving" in o[0] or "swinging" in o[0] for o in obstacles):
        check_arrived(flown, 0.05)
