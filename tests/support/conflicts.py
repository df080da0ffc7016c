"""Conflicts of a path with obstacles whose motion is known."""

from idc_controller.geometry.free_space import TOUCHING, FreeSpace


def first_conflict(positions, obstacles, formation, margin):
    """Index of the first of positions (K, 3) nearer than margin (m) to an obstacle as predicted then; None: none."""
    for k, place in enumerate(positions):
        moments = [min(k, len(o.positions) - 1) for o in obstacles]
        bodies = [(o.shape, o.positions[at]) for o, at in zip(obstacles, moments, strict=True)]
        growth = [o.growth[at] for o, at in zip(obstacles, moments, strict=True)]
        space = FreeSpace(bodies, formation, margin, -1e3, 1e3, growth)
        if (space.clearance(place[None]) < margin - TOUCHING).any():
            return k
    return None
