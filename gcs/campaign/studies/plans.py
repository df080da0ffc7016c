"""Plans of studies (``gcs study``): the same missions flown again with one parameter changed at a time."""

import dataclasses
import json
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from itertools import count
from pathlib import Path
from typing import Any

from pydantic import TypeAdapter
from rich.console import RenderableType

from gcs.campaign.engine import PlanGenerator
from gcs.campaign.flight import FlightPlan
from gcs.campaign.folder import digest, plain
from gcs.campaign.result import Result
from gcs.campaign.scenarios.generator import HELD_TO, generate
from gcs.campaign.scenarios.judgement import COLUMNS, judge
from gcs.campaign.scenarios.moving import top_speed
from gcs.campaign.scenarios.plans import Scenarios
from gcs.campaign.studies.study import MARGIN, MOVING, Study, Variant
from gcs.campaign.toml_text import system_text
from gcs.config import SystemConfig
from gcs.config.text_file import read_text
from gcs.mission.motion import AnyMotion, Motion
from gcs.mission.read import read_mission

FAST = 0.85
"""Share of the highest speed that the fastest obstacle of a moving scenario reaches at least."""


class StudyFlights(PlanGenerator):
    """Every variant of a study in every mission with every seed.

    A name holds everything that the flight is flown by, except the program: studies in one folder share flights.
    """

    columns = COLUMNS
    shown = Scenarios.shown

    def __init__(
        self, study: Study, seeds: int | None = None, quick: bool = False, missions: Path = Path("missions")
    ) -> None:
        """``seeds``: flights of each variant; None: the study's own number."""
        self.study = study
        self._seeds = seeds or (study.quick if quick else study.seeds)
        self._missions = missions.absolute()
        self._moving: dict[float, tuple[list[str], Iterator[str]]] = {}

    def plans(self, out: Path) -> Iterator[FlightPlan]:
        """Yield all flights, by mission, then variant, then seed. Raises :class:`UnusableInput` without a mission."""
        study, seeds = self.study, range(1, self._seeds + 1)
        flights = [(m, v, s) for m in study.missions for v in study.variants for s in seeds]
        for number, (mission, variant, seed) in enumerate(flights, start=1):
            yield self._plan(out, number, mission, variant, seed)

    def report(self, results: Sequence[Result], out: Path) -> tuple[list[RenderableType], list[Path]]:
        """Write ``NAME.csv`` and ``NAME.png``."""
        from gcs.campaign.studies.report import report  # matplotlib takes long to import

        return report(self.study, results, out)

    def _plan(self, out: Path, number: int, mission: str, variant: Variant, seed: int) -> FlightPlan:
        files: dict[Path, str] = {}
        # Compared by their text: a flight of another study of the folder is the same where its values are.
        changes = _real_changes(variant.changes)
        system, changed = system_text(changes), _text_of(changes)
        config, noise = None, None
        if changes:
            config = out / "systems" / f"{plain(changed)}.toml"
            files[config] = system
        if mission == MOVING:
            title = f"moving{variant.fastest:g}"
            path, text = out / "missions" / f"{title}-{seed:04d}.toml", self._moving_scenario(variant.fastest, seed)
            files[path] = text
            held_to = HELD_TO
        else:
            title, path = mission, self._missions / f"{mission}.toml"
            text = read_text(path)
            limits = read_mission(path).limits or HELD_TO
            noise = seed
            # A mission with a clearance limit is held to the margin, where that is what is changed.
            clearance = variant.changes.get(MARGIN, limits.clearance) if limits.clearance is not None else None
            held_to = dataclasses.replace(limits, clearance=clearance)
        title = " ".join([title, variant.controller, changed, f"seed{seed}"])
        name = plain(f"{title} {digest(text, system, repr(held_to))}")
        labels = {
            "kind": variant.label, "mission": mission, "variant": variant.label, "seed": seed,
            "clearance_asked_m": held_to.clearance, "tilt_limit_deg": held_to.payload_tilt_deg,
        }  # fmt: skip
        judgement = partial(judge, path, config, held_to, None)
        return FlightPlan(number, name, path, judgement, variant.controller, config, noise, labels, files)

    def _moving_scenario(self, fastest: float, number: int) -> str:
        """Return the mission of a random scenario of seed 1."""
        texts, more = self._moving.setdefault(fastest, ([], fast_scenarios(fastest)))
        while len(texts) < number:
            texts.append(next(more))
        return texts[number - 1]


def fast_scenarios(fastest: float) -> Iterator[str]:
    """Yield the missions of kind "moving" of seed 1 whose fastest obstacle reaches about ``fastest`` (m/s).

    A scenario has obstacles of any speed up to that. These are chosen by their obstacles, not by their flights.
    """
    motions: TypeAdapter[AnyMotion] = TypeAdapter(Motion)
    for number in count(1):
        text = generate(1, number, "moving", fastest=fastest).text
        obstacles = tomllib.loads(text)["obstacle"]
        speeds = [top_speed(motions.validate_json(json.dumps(obstacle["motion"]))) for obstacle in obstacles]
        if max(speeds) >= FAST * fastest:
            # Obstacles of the map are known at any distance: here the sensors have to detect all.
            yield text.replace("known = true", "known = false")


def _real_changes(changes: Mapping[str, Any]) -> dict[str, Any]:
    """Return ``changes`` without those that leave the value of the default system."""
    tables = SystemConfig().tables()
    return {key: value for key, value in changes.items() if _lookup(tables, key) != value}


def _lookup(tables: Mapping[str, Any], key: str) -> Any:
    found: Any = tables
    for part in key.split("."):
        found = found[part]
    return found


def _text_of(changes: Mapping[str, Any]) -> str:
    return " ".join(f"{key.rpartition('.')[2]} {value}" for key, value in changes.items())
