"""Random obstacle scenarios: a path and obstacles on it, from a seed and a number.

Drafts are drawn until one can be flown by construction: start and goal are clear by 3 m, there is a detour round all
static obstacles, moving obstacles keep clear of them, and none approaches the payload while it takes off or lands. Of
boxes, forests, rooms and overhangs the narrowest gap is known besides; some forests and rooms have no way.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from gcs.campaign.scenarios.boxes import boxes
from gcs.campaign.scenarios.draft import Contents, Draft
from gcs.campaign.scenarios.forest import forest
from gcs.campaign.scenarios.layout import Layout, Random
from gcs.campaign.scenarios.moving import SLOWEST, STOP_AND_GO_SPEEDS
from gcs.campaign.scenarios.overhang import overhang
from gcs.campaign.scenarios.passage import Passage, Passages, passage_comments
from gcs.campaign.scenarios.rooms import rooms
from gcs.campaign.toml_text import mission_text
from gcs.config import SystemConfig, read_system
from gcs.errors import GcsError
from gcs.flight.stack import closing_speed_limit
from gcs.mission.model import Limits, Lissajous, Obstacle

HELD_TO = Limits(clearance=0.3, payload_tilt_deg=6.0)

MAX_DRAFTS = 400


@dataclass(frozen=True)
class RandomScenario:
    """One scenario: ``text`` is the mission file, ``passage`` None where it can be passed by construction."""

    number: int
    kind: str
    name: str
    text: str
    passage: Passage | None = None


def generate(
    seed: int, number: int, kind: str, config: SystemConfig | None = None, fastest: float = 2.0
) -> RandomScenario:
    """Return scenario ``number`` of ``seed``; obstacles move at up to ``fastest`` (m/s).

    What stops and goes, and what approaches, has speeds of its own.

    ``config`` is the system that flies it; None: the default. The same arguments give the same scenario.
    Raises :class:`GcsError` if no draft can be flown.
    """
    system = read_system(None) if config is None else config
    random = np.random.default_rng([seed, number, KINDS.index(kind)])
    draw: Callable[[Random], _Drawn | None]
    if kind == APPROACHING:
        draw = partial(_approached, system, closing_speed_limit(system))
    elif kind in _LAYOUTS:
        draw = partial(_lay_out, kind, Passages(system))
    else:
        draw = partial(_draft, kind, system, fastest)
    name = f"{number:04d}-{kind}"
    for _ in range(MAX_DRAFTS):
        if (drawn := draw(random)) is not None:
            comments = [f"Random course {number} of seed {seed}, kind {kind}.", *passage_comments(drawn.passage)]
            noise_seed = int(random.integers(2**31))
            text = mission_text(name, noise_seed, drawn.reference, drawn.obstacles, HELD_TO, comments)
            return RandomScenario(number, kind, name, text, drawn.passage)
    raise GcsError(f"scenario {number} of seed {seed}: none of {MAX_DRAFTS} drafts can be flown: take another seed")


@dataclass(frozen=True)
class _Drawn:
    reference: Lissajous | Mapping[str, Any]
    obstacles: Sequence[Obstacle]
    passage: Passage | None = None


def _draft(kind: str, system: SystemConfig, fastest: float, random: Random) -> _Drawn | None:
    draft = Draft(random, system, STOP_AND_GO_SPEEDS[1] if kind == STOP_AND_GO else fastest)
    draft.draw(_CONTENTS[kind])
    return _Drawn(draft.reference, draft.obstacles) if draft.can_be_flown() else None


def _approached(system: SystemConfig, closing: float, random: Random) -> _Drawn | None:
    """Draw a path that one obstacle meets from any bearing, at 0.7 to 1 times the largest ``closing`` speed (m/s)."""
    own = round(random.uniform(OWN_SPEEDS[0], min(OWN_SPEEDS[1], closing - 2.0 * SLOWEST)), 3)
    obstacle = max(random.uniform(0.7, 1.0) * closing - own, SLOWEST)
    draft = Draft(random, system, obstacle)
    draft.lay_straight(own)
    draft.add_approaching(random.uniform(18.0, 22.0), obstacle)
    return _Drawn(draft.reference, draft.obstacles) if draft.can_be_flown() else None


def _lay_out(kind: str, passages: Passages, random: Random) -> _Drawn | None:
    layout = _LAYOUTS[kind](random, passages)
    if (passage := layout.passage(passages)) is None:
        return None
    reference = {"points": layout.points, "speed": layout.speed, "return_home": False}
    return _Drawn(reference, layout.obstacles, passage)


STOP_AND_GO, APPROACHING = "stop_and_go", "approaching"
OWN_SPEEDS = (1.0, 2.5)
"""Of the team in scenarios with an approaching obstacle (m/s)."""
_CONTENTS = {
    "spheres": Contents(0.25, ((1, 4, (Draft.add_sphere,)),)),
    "poles": Contents(0.0, ((1, 4, (Draft.add_poles,)),)),
    "walls": Contents(0.0, ((1, 2, (Draft.add_wall,)),)),
    "moving": Contents(0.25, ((1, 3, (Draft.add_moving,)),)),
    "mixed": Contents(0.0, ((1, 2, (Draft.add_moving,)), (1, 3, (Draft.add_sphere, Draft.add_poles, Draft.add_wall)))),
    STOP_AND_GO: Contents(0.0, ((1, 3, (Draft.add_stop_and_go,)),)),
}
_LAYOUTS: dict[str, Callable[[Random, Passages], Layout]] = {
    "boxes": boxes,
    "forest": forest,
    "rooms": rooms,
    "overhang": overhang,
}
KINDS = ("spheres", "poles", "walls", "moving", "mixed", *_LAYOUTS, STOP_AND_GO, APPROACHING)
DEFAULT_KINDS = KINDS[:5]
"""The kinds that are flown where none are named."""
