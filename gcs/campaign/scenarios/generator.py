"""Random obstacle scenarios: a path and obstacles on it, from a seed and a number.

Drafts are drawn until one can be flown by construction: start and goal are clear by 3 m, there is a detour round all
static obstacles, moving obstacles keep clear of them, and none approaches the payload while it takes off or lands.
"""

from dataclasses import dataclass

import numpy as np

from gcs.campaign.scenarios.draft import Contents, Draft
from gcs.campaign.toml_text import mission_text
from gcs.config import SystemConfig, read_system
from gcs.errors import GcsError
from gcs.mission.model import Limits

HELD_TO = Limits(clearance=0.3, payload_tilt_deg=6.0)

MAX_DRAFTS = 400


@dataclass(frozen=True)
class RandomScenario:
    """One scenario: ``text`` is the mission file."""

    number: int
    kind: str
    name: str
    text: str


def generate(
    seed: int, number: int, kind: str, config: SystemConfig | None = None, fastest: float = 2.0
) -> RandomScenario:
    """Return scenario ``number`` of ``seed``; obstacles move at up to ``fastest`` (m/s).

    ``config`` is the system that flies it; None: the default. The same arguments give the same scenario.
    Raises :class:`GcsError` if no draft can be flown.
    """
    system = read_system(None) if config is None else config
    random = np.random.default_rng([seed, number, KINDS.index(kind)])
    name = f"{number:04d}-{kind}"
    for _ in range(MAX_DRAFTS):
        draft = Draft(random, system, fastest)
        draft.draw(_CONTENTS[kind])
        if draft.can_be_flown():
            comment = f"Random course {number} of seed {seed}, kind {kind}."
            noise_seed = int(random.integers(2**31))
            text = mission_text(name, noise_seed, draft.reference, draft.obstacles, HELD_TO, [comment])
            return RandomScenario(number, kind, name, text)
    raise GcsError(f"scenario {number} of seed {seed}: none of {MAX_DRAFTS} drafts can be flown: take another seed")


_CONTENTS = {
    "spheres": Contents(0.25, ((1, 4, (Draft.add_sphere,)),)),
    "poles": Contents(0.0, ((1, 4, (Draft.add_poles,)),)),
    "walls": Contents(0.0, ((1, 2, (Draft.add_wall,)),)),
    "moving": Contents(0.25, ((1, 3, (Draft.add_moving,)),)),
    "mixed": Contents(0.0, ((1, 2, (Draft.add_moving,)), (1, 3, (Draft.add_sphere, Draft.add_poles, Draft.add_wall)))),
}
KINDS = tuple(_CONTENTS)
