"""What hangs over the mission's way: beams on posts, bridges on piers, roofs on posts."""

import math
from collections.abc import Callable

from gcs.campaign.scenarios.layout import Layout, Random, above_pad, leg
from gcs.campaign.scenarios.passage import Passages

SPACING = 11.0
"""m between two structures along the path, at least."""
BEAM_ABOVE = (2.5, 9.0)
"""m from the ground to the underside of a beam."""
DECK_ABOVE = (4.0, 9.0)
"""m from the ground to the underside of a bridge or a roof."""


def overhang(random: Random, passages: Passages) -> Layout:
    """Return one to three structures across a straight way; each can be passed under or over."""
    count = int(random.integers(1, 4))
    length = random.uniform(20.0, 28.0) + SPACING * (count - 1)
    heading = random.uniform(-math.pi, math.pi)
    layout = Layout([leg(above_pad(random.uniform(4.0, 6.0)), length, heading)], round(random.uniform(1.5, 2.5), 3))
    spare = length - 20.0 - SPACING * (count - 1)
    offsets = sorted(random.uniform(0.0, spare, count).tolist())
    for number, offset in enumerate(offsets):
        build = _STRUCTURES[random.integers(len(_STRUCTURES))]
        place, heading = layout.at(10.0 + offset + SPACING * number, random.uniform(-2.0, 2.0))
        build(layout, random, place, heading + math.radians(random.uniform(-20.0, 20.0)))
    return layout


def _at(place: tuple[float, float], heading: float, along: float, aside: float) -> tuple[float, float]:
    cosine, sine = math.cos(heading), math.sin(heading)
    return place[0] + along * cosine - aside * sine, place[1] + along * sine + aside * cosine


def _beam(layout: Layout, random: Random, place: tuple[float, float], heading: float) -> None:
    """Add a beam across the way on two posts."""
    span, above = random.uniform(8.0, 16.0), random.uniform(*BEAM_ABOVE)
    size = (random.uniform(0.3, 0.8), span, random.uniform(0.3, 1.2))
    layout.add_wall("beam", place, size, heading, above)
    radius = random.uniform(0.12, 0.3)
    for side in (-1.0, 1.0):
        layout.add_pole("post", _at(place, heading, 0.0, side * (span / 2.0 - radius)), radius, above)


def _bridge(layout: Layout, random: Random, place: tuple[float, float], heading: float) -> None:
    """Add a bridge across the way on two piers."""
    deck, span, above = random.uniform(3.0, 6.0), random.uniform(14.0, 24.0), random.uniform(*DECK_ABOVE)
    layout.add_wall("deck", place, (deck, span, random.uniform(0.5, 1.2)), heading, above)
    pier = random.uniform(0.6, 1.2)
    for side in (-1.0, 1.0):
        middle = _at(place, heading, 0.0, side * (span / 2.0 - pier / 2.0))
        layout.add_wall("pier", middle, (0.8 * deck, pier, above), heading)


def _roof(layout: Layout, random: Random, place: tuple[float, float], heading: float) -> None:
    """Add a roof on four posts."""
    depth, width, above = random.uniform(5.0, 9.0), random.uniform(8.0, 14.0), random.uniform(*DECK_ABOVE)
    layout.add_wall("roof", place, (depth, width, random.uniform(0.2, 0.5)), heading, above)
    radius = random.uniform(0.1, 0.2)
    for end in (-1.0, 1.0):
        for side in (-1.0, 1.0):
            corner = _at(place, heading, end * (depth / 2.0 - 0.3), side * (width / 2.0 - 0.3))
            layout.add_pole("post", corner, radius, above)


_STRUCTURES: tuple[Callable[[Layout, Random, tuple[float, float], float], None], ...] = (_beam, _bridge, _roof)
