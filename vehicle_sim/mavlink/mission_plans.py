"""Mission, fence and rally points of a vehicle: those of one that flies by itself, and none of one on a payload."""

import math
from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.answer import Answer
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mavlink.services.mission_store import TAKEN, MissionAnswer, MissionProgress
from gcs.mavlink.services.plans import MissionFlight, Plans, refusal
from gcs.mission.items import FileHome, ItemError
from gcs.mission.items import MissionItem as FileItem
from gcs.mission.model import Home
from gcs.mission.px4_items import (
    check_fence,
    check_fence_item,
    check_jumps,
    check_mission_item,
    check_rally_point,
    why_unflyable,
)
from vehicle_sim.autopilot.modes import team_only

_MODE_SUSPENDED = 2
"""No mode is active that flies the mission."""
_CHECKS = {
    PlanType.MISSION: check_mission_item,
    PlanType.FENCE: check_fence_item,
    PlanType.RALLY: check_rally_point,
}


class CoupledPlans:
    """No plans: a vehicle on a payload flies no mission by itself."""

    def changes(self) -> int:
        """Return 0: nothing changes."""
        return 0

    def items_of(self, plan_type: PlanType) -> tuple[MissionItem, ...]:
        """Return nothing."""
        return ()

    def id_of(self, plan_type: PlanType) -> int:
        """Return 0: there is no plan."""
        return 0

    def begin(self, plan_type: PlanType) -> MissionAnswer:
        """Refuse."""
        return MissionAnswer(mavlink.MAV_MISSION_DENIED, team_only("Mission upload").text)

    def check(self, plan_type: PlanType, item: MissionItem, number: int) -> MissionAnswer:
        """Refuse."""
        return self.begin(plan_type)

    def accept(self, plan_type: PlanType, items: tuple[MissionItem, ...], current: int) -> MissionAnswer:
        """Refuse."""
        return self.begin(plan_type)

    def set_current(self, number: int, now: float, *, reset: bool = False) -> Answer:
        """Refuse."""
        return team_only("Mission item")

    def progress(self) -> MissionProgress:
        """Return that there is no mission."""
        return MissionProgress(0, 0, mavlink.MISSION_STATE_NO_MISSION, _MODE_SUSPENDED)

    def take_reached(self) -> tuple[int, ...]:
        """Return nothing."""
        return ()

    def reached_again(self) -> int | None:
        """Return nothing."""
        return None


class MissionPlans(Plans):
    """Plans of a vehicle that flies by itself."""

    def __init__(self, home: Home, flight: MissionFlight) -> None:
        """``home`` is that from which the distances of the items are limited; ``flight`` gets each new plan."""
        super().__init__(flight, _Rules(FileHome(home.latitude, home.longitude, home.altitude)))


class _Rules:
    """What PX4 takes, as far as it is flown or may be left out."""

    def __init__(self, home: FileHome) -> None:
        self._home = home

    def check_item(self, plan_type: PlanType, item: MissionItem, number: int) -> MissionAnswer:
        """See :meth:`.PlanRules.check_item`."""
        try:
            _CHECKS[plan_type](_as_in_file(item, number))
        except ItemError as error:
            return refusal(error.field, str(error), f"{plan_type.name.capitalize()} item {number}")
        return TAKEN

    def check_plan(self, plan_type: PlanType, items: Sequence[MissionItem]) -> MissionAnswer:
        """See :meth:`.PlanRules.check_plan`: refused if it refers to items that it does not have."""
        as_in_file = [_as_in_file(item, number) for number, item in enumerate(items)]
        try:
            if plan_type == PlanType.MISSION:
                check_jumps(as_in_file)
            elif plan_type == PlanType.FENCE:
                check_fence(as_in_file)
        except ItemError as error:
            return refusal(error.field, str(error), plan_type.name.capitalize())
        return TAKEN

    def why_unflyable(self, items: Sequence[MissionItem]) -> str | None:
        """See :meth:`.PlanRules.why_unflyable`."""
        as_in_file = [_as_in_file(item, number) for number, item in enumerate(items)]
        return why_unflyable(as_in_file, self._home) if items else None


def _as_in_file(item: MissionItem, number: int) -> FileItem:
    """Return an item as mission files have it: places in deg, None for what is not given."""
    given = [None if value is None or math.isnan(value) else value for value in item.parameters]
    return FileItem(f"item {number}", number, item.frame, item.command, tuple(given), item.autocontinue)
