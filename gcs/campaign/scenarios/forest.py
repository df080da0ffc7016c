"""A forest across the mission's way: trunks, some of them with a crown."""

import math

import numpy as np

from gcs.campaign.scenarios.layout import END_CLEARANCE, Layout, Random, above_pad, leg
from gcs.campaign.scenarios.passage import Passages

DENSITIES = (0.04, 0.12)
"""Trees per square metre."""
RADII = (0.08, 0.35)
"""Of trunks (m): diameters at breast height of 16 to 70 cm."""
CROWNED = 0.35
"""Share of the trees with a crown."""
CROWNS = (0.8, 2.2)
"""Radii of crowns (m)."""
DEPTHS, WIDTHS, ROUND_CLEARING = (18.0, 36.0), (16.0, 30.0), (26.0, 36.0)
"""m along the way and across, and both where the goal is in a clearing."""
IN_CLEARING = 0.3
"""Share of the forests with the goal in a clearing."""
APART = 0.9
"""m between the middles of two trunks, at least."""


def forest(random: Random, passages: Passages) -> Layout:
    """Return a forest of one density; the goal is behind it or in a clearing, to which there may be no way."""
    heading = random.uniform(-math.pi, math.pi)
    near = passages.formation.radius + END_CLEARANCE + CROWNS[1] + 0.1
    density, in_clearing = random.uniform(*DENSITIES), random.random() < IN_CLEARING
    depth, width = (random.uniform(*(ROUND_CLEARING if in_clearing else edges)) for edges in (DEPTHS, WIDTHS))
    length = near + (0.5 * depth if in_clearing else depth + near)
    way = [leg(above_pad(random.uniform(4.0, 6.0)), length, heading)]
    layout = Layout(way, round(random.uniform(1.5, 2.5), 3), None)
    trees, area = np.empty((0, 2)), depth * width - in_clearing * math.pi * near**2
    free = (length - near, 0.0) if in_clearing else (math.inf, 0.0)
    for _ in range(20000):
        if len(trees) >= round(density * area):
            break
        place = random.uniform([0.0, -width / 2.0], [depth, width / 2.0])
        apart = np.hypot(*(trees - place).T).min(initial=math.inf)
        if apart >= APART and math.dist(place, free) > near:
            trees = np.vstack([trees, place])
    for x, y in trees.tolist():
        _add_tree(layout, random, layout.at(near + x, y)[0])
    return layout


def _add_tree(layout: Layout, random: Random, place: tuple[float, float]) -> None:
    """Add a trunk, and on a low one a crown."""
    radius = float(np.clip(random.lognormal(math.log(0.16), 0.4), *RADII))
    if random.random() >= CROWNED:
        layout.add_pole("trunk", place, radius, random.uniform(12.0, 25.0))
        return
    height, crown = random.uniform(4.0, 12.0), random.uniform(*CROWNS)
    layout.add_pole("trunk", place, radius, height)
    layout.add_sphere("crown", place, height + 0.7 * crown, crown)
