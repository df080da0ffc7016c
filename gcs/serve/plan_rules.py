"""Which plans the team takes: those that it could fly, at once or from the next take-off on."""

from collections.abc import Sequence

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.config.validate import UnusableFile
from gcs.mavlink.services.mission_item import MissionItem, PlanType
from gcs.mavlink.services.mission_store import TAKEN, MissionAnswer
from gcs.serve.aircraft import TeamAircraft
from gcs.serve.plan_file import UPLOADED, mission_of

_FLYING = MissionAnswer(mavlink.MAV_MISSION_ERROR, "Fence refused: change it on the ground, before arming")


class TeamPlanRules:
    """A :class:`.PlanRules`: a plan is read as a whole, as ``gcs check`` reads a file."""

    def __init__(self, aircraft: TeamAircraft) -> None:
        self._aircraft = aircraft

    def check_item(self, plan_type: PlanType, item: MissionItem, number: int) -> MissionAnswer:
        """See :meth:`.PlanRules.check_item`: an item is checked with the whole plan."""
        return TAKEN

    def check_plan(self, plan_type: PlanType, items: Sequence[MissionItem]) -> MissionAnswer:
        """See :meth:`.PlanRules.check_plan`."""
        session = self._aircraft.session
        if plan_type == PlanType.FENCE and session.is_armed:
            return _FLYING
        try:
            mission_of({**self._aircraft.plans, plan_type: items}, self._aircraft.base)
        except UnusableFile as error:
            text = error.reasons[0].removeprefix(f"{UPLOADED}: ")
            return MissionAnswer(mavlink.MAV_MISSION_ERROR, f"{plan_type.name.capitalize()} refused: {text}")
        return TAKEN

    def why_unflyable(self, items: Sequence[MissionItem]) -> str | None:
        """See :meth:`.PlanRules.why_unflyable`: a mission that was taken can be flown."""
        return None
