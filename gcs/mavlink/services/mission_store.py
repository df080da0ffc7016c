"""What the mission protocol serves: the plans of an aircraft, and what it accepts of those that are uploaded."""

from typing import NamedTuple, Protocol

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.answer import Answer
from gcs.mavlink.services.mission_item import MissionItem, PlanType


class MissionAnswer(NamedTuple):
    """The outcome of an upload: a MAV_MISSION_RESULT, and the reason, as STATUSTEXT."""

    result: int
    text: str = ""

    @property
    def is_accepted(self) -> bool:
        """Whether the upload goes on, or is taken over."""
        return self.result == mavlink.MAV_MISSION_ACCEPTED


TAKEN = MissionAnswer(mavlink.MAV_MISSION_ACCEPTED)


class MissionProgress(NamedTuple):
    """Item that is flown to, number of items, MISSION_STATE, and whether a mode flies the mission (0 unknown, 1, 2)."""

    current: int
    total: int
    state: int
    mode: int


class MissionStore(Protocol):
    """Mission, fence and rally points of an aircraft."""

    def items_of(self, plan_type: PlanType) -> tuple[MissionItem, ...]:
        """Return the items of a plan that is in effect."""

    def id_of(self, plan_type: PlanType) -> int:
        """Return the opaque id of a plan that is in effect."""

    def begin(self, plan_type: PlanType) -> MissionAnswer:
        """Return whether a plan may be uploaded now; a refusal says why."""

    def check(self, plan_type: PlanType, item: MissionItem, number: int) -> MissionAnswer:
        """Return whether item ``number`` of a plan can be taken by itself."""

    def accept(self, plan_type: PlanType, items: tuple[MissionItem, ...], current: int) -> MissionAnswer:
        """Take over a whole plan whose items were checked, the mission at item ``current``; or refuse all of it."""

    def set_current(self, number: int, now: float, *, reset: bool = False) -> Answer:
        """Fly to item ``number`` next; ``reset``: count jumps anew, and fly a completed mission again."""

    def changes(self) -> int:
        """Return a number that rises when the progress or a plan has changed, or an item was reached."""

    def progress(self) -> MissionProgress:
        """Return what MISSION_CURRENT says."""

    def take_reached(self) -> tuple[int, ...]:
        """Return the items reached since the last call."""

    def reached_again(self) -> int | None:
        """Return the item whose reaching is still to be repeated, once; None: none."""
