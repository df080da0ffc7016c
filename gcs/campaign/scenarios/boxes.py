"""Boxes as buildings stand about the legs of a mission, in the sizes of the UAV testing competitions."""

import math

import numpy as np
import shapely

from gcs.campaign.scenarios.layout import Layout, Random, above_pad, leg
from gcs.campaign.scenarios.passage import Passages

SPEED = 2.5
"""m/s."""
EDGES = (2.0, 20.0)
"""m."""
HEIGHTS = (6.0, 25.0)
"""m."""
MOST = 5
ASIDE = 6.0
"""m from the path to a box's nearest side, at most."""
APART = 0.5
"""m between two boxes, at least."""


def boxes(random: Random, passages: Passages) -> Layout:
    """Return one to five boxes, turned, about a way of one to three legs; there is a way round."""
    heading = random.uniform(-math.pi, math.pi)
    points = [leg(above_pad(random.uniform(5.0, 10.0)), random.uniform(35.0, 55.0), heading)]
    for turn in ((90.0, 15.0, 25.0), (90.0, 30.0, 50.0))[: random.integers(3)]:  # aside, and back
        heading += math.radians(turn[0] + random.uniform(-15.0, 15.0))
        points.append(leg(points[-1], random.uniform(*turn[1:]), heading))
    layout = Layout(points, SPEED)
    for _ in range(random.integers(1, MOST + 1)):
        for _ in range(30):
            if _add_box(layout, random, passages):
                break
    return layout


def _add_box(layout: Layout, random: Random, passages: Passages) -> bool:
    """Add a box, unless it meets another one or stands at a waypoint."""
    length, width, height = random.uniform(*EDGES), random.uniform(*EDGES), random.uniform(*HEIGHTS)
    yaw = math.radians(random.uniform(0.0, 180.0))
    along = random.uniform(0.15, 0.9) * layout.length
    aside = random.choice([-1.0, 1.0]) * (random.uniform(-0.5, 0.5) * min(length, width) + random.uniform(0.0, ASIDE))
    box = layout.add_wall("box", layout.at(along, aside)[0], (length, width, height), yaw)
    outlines = [
        shapely.affinity.translate(o.shape.plan_view.core, *np.array(o.position[:2]).tolist()) for o in layout.obstacles
    ]
    apart = min((outlines[-1].distance(other) for other in outlines[:-1]), default=math.inf)
    path = shapely.LineString([place[:2] for place in layout.places])
    if apart >= APART and outlines[-1].distance(path) <= ASIDE and layout.is_clear(passages, [box]):
        return True
    layout.obstacles.pop()
    return False
