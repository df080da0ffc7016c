"""Missions of a campaign that are drawn: with every seed another random scenario, or field of obstacles."""

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, Literal

from pydantic import Field

from gcs.campaign.faults.base_mission import BaseMission
from gcs.campaign.scenarios.field import FIELD, LAP, MOST, field_text
from gcs.campaign.scenarios.generator import KINDS, generate
from gcs.config import read_system
from gcs.config.validate import strict
from gcs.errors import GcsError
from gcs.mission.model import Name


@strict
@dataclass(frozen=True)
class ScenarioTable:
    """``[[scenario]]``: a mission of one of :data:`KINDS`, or a field of ``obstacles``, all ``known`` or none.

    ``duration`` (s) is that of the figure eight in a field.
    """

    name: Name
    kind: Literal[FIELD, *KINDS]  # type: ignore[valid-type]
    obstacles: Annotated[int, Field(ge=0, le=MOST)] | None = None
    known: bool | None = None
    duration: Annotated[float, Field(gt=0.0, le=3000.0)] | None = None

    def text(self, seed: int) -> str:
        """Return the mission of a seed: of those that are drawn the first that can be passed."""
        system = read_system(None)
        if self.kind == FIELD:
            return field_text(seed, self.obstacles or 0, bool(self.known), self.duration or LAP, system)
        for number in range(1, 100):
            scenario = generate(seed, number, self.kind, system)
            if scenario.passage is None or scenario.passage.verdict == "passable":
                return scenario.text
        raise GcsError(f"{self.kind}: none of 100 scenarios of seed {seed} can be passed")


@dataclass(frozen=True)
class DrawnMission(BaseMission):
    """A mission that is drawn for each seed."""

    table: ScenarioTable

    @classmethod
    def of(cls, table: ScenarioTable) -> "DrawnMission":
        """Return the mission of a table of the campaign file, which the default system flies."""
        return cls(table.name, 1, read_system(None), {}, {}, table)

    def tables_for(self, seed: int) -> Mapping[str, Any]:
        """Return the tables of the mission that is drawn with a seed."""
        return tomllib.loads(self.table.text(seed))
