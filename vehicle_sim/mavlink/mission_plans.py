"""Mission, fence and rally points of a vehicle: those of one that flies by itself, and none of one on a payload."""

import math

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.answer import ACCEPTED, Answer, denied
from gcs.mavlink.services.mission_item import UNKNOWN, MissionItem, PlanType, opaque_id
from gcs.mavlink.services.mission_store import TAKEN, MissionAnswer, MissionProgress
from gcs.mission.commands import Frame
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

_REACHED_REPEATS = 10
"""PX4 says so often again which item was reached."""
_MODE_UNKNOWN, _MODE_ACTIVE, _MODE_SUSPENDED = 0, 1, 2
_RESULTS = {
    "frame": mavlink.MAV_MISSION_UNSUPPORTED_FRAME,
    "command": mavlink.MAV_MISSION_UNSUPPORTED,
    "latitude": mavlink.MAV_MISSION_INVALID_PARAM5_X,
    "longitude": mavlink.MAV_MISSION_INVALID_PARAM6_Y,
    "latitude, longitude": mavlink.MAV_MISSION_INVALID_PARAM5_X,
    "altitude": mavlink.MAV_MISSION_INVALID_PARAM7,
}
"""MAV_MISSION_RESULT by the field that an :class:`ItemError` names; of parameters by their number."""
_CHECKS = {
    PlanType.MISSION: check_mission_item,
    PlanType.FENCE: check_fence_item,
    PlanType.RALLY: check_rally_point,
}


class CoupledPlans:
    """No plans: a vehicle on a payload flies no mission by itself."""

    changes = 0

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

    def set_current(self, number: int, *, reset: bool = False) -> Answer:
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


class MissionPlans:
    """Plans of a vehicle that flies by itself.

    Its flight reads :attr:`items` and :attr:`current`, and calls :meth:`fly_to`, :meth:`reached` and :meth:`report`;
    when :attr:`revision` has changed the ground has uploaded another mission or chosen another item.
    """

    def __init__(self, home: Home) -> None:
        """``home`` is that from which the distances of the items are limited."""
        self._home = FileHome(home.latitude, home.longitude, home.altitude)
        self._plans: dict[PlanType, tuple[MissionItem, ...]] = dict.fromkeys(PlanType, ())
        self._ids = dict.fromkeys(PlanType, 0)
        self._reached: list[int] = []
        self._reached_left = 0
        self._last_reached: int | None = None
        self._is_flown = False
        self._is_complete = False
        self.current = 0
        """Number of the item that is flown to."""
        self.revision = 0
        """Number of missions uploaded and items chosen by the ground."""
        self.resets = 0
        """Number of times that the ground has had jumps counted anew."""
        self.problem: str | None = None
        """Reason why the mission cannot be started; None if it can, or there is none."""
        self.changes = 0

    # The flight's side

    @property
    def items(self) -> tuple[MissionItem, ...]:
        """The mission."""
        return self._plans[PlanType.MISSION]

    @property
    def fence(self) -> tuple[MissionItem, ...]:
        """The fence."""
        return self._plans[PlanType.FENCE]

    @property
    def rally_points(self) -> tuple[MissionItem, ...]:
        """The rally points."""
        return self._plans[PlanType.RALLY]

    def fly_to(self, number: int) -> None:
        """Make item ``number`` the current one, in the course of the flight."""
        if number != self.current:
            self.current = number
            self.changes += 1

    def reached(self, number: int) -> None:
        """Send that item ``number`` was reached."""
        self._reached.append(number)
        self._last_reached, self._reached_left = number, _REACHED_REPEATS
        self.changes += 1

    def report(self, *, is_flown: bool, is_complete: bool) -> None:
        """Report whether the mode that flies the mission is active, and whether the mission is complete."""
        if (is_flown, is_complete) != (self._is_flown, self._is_complete):
            self._is_flown, self._is_complete = is_flown, is_complete
            self.changes += 1

    # The ground's side

    def items_of(self, plan_type: PlanType) -> tuple[MissionItem, ...]:
        """Return the items of a plan."""
        return self._plans[plan_type]

    def id_of(self, plan_type: PlanType) -> int:
        """Return the opaque id of a plan."""
        return self._ids[plan_type]

    def begin(self, plan_type: PlanType) -> MissionAnswer:
        """Return that a plan may be uploaded at any time, in flight, too."""
        return TAKEN

    def check(self, plan_type: PlanType, item: MissionItem, number: int) -> MissionAnswer:
        """Return whether an item is one that PX4 takes and that is flown or may be left out."""
        try:
            _CHECKS[plan_type](_as_in_file(item, number))
        except ItemError as error:
            return _refusal(error, f"{plan_type.name.capitalize()} item {number}")
        return TAKEN

    def accept(self, plan_type: PlanType, items: tuple[MissionItem, ...], current: int) -> MissionAnswer:
        """Take over a plan, unless it refers to items that it does not have.

        As in PX4 a mission that was taken may be one that cannot be started, and :attr:`problem` says why; the same
        mission once more changes nothing.
        """
        as_in_file = [_as_in_file(item, number) for number, item in enumerate(items)]
        problem = None
        try:
            if plan_type == PlanType.MISSION:
                check_jumps(as_in_file)
                problem = why_unflyable(as_in_file, self._home) if items else None
            elif plan_type == PlanType.FENCE:
                check_fence(as_in_file)
        except ItemError as error:
            return _refusal(error, plan_type.name.capitalize())
        identity = opaque_id(items)
        if identity != self._ids[plan_type] or not items:
            self._plans[plan_type], self._ids[plan_type] = items, identity
            self.changes += 1
            if plan_type == PlanType.MISSION:
                self.problem = problem
                self._begin_at(current)
        return MissionAnswer(TAKEN.result, f"Mission cannot be started: {problem}" if problem else "")

    def set_current(self, number: int, *, reset: bool = False) -> Answer:
        """Choose the item to be flown to."""
        if not number < len(self.items):
            return denied(f"Mission item denied: {number} of {len(self.items)} items")
        self.resets += reset
        self._begin_at(number)
        return ACCEPTED

    def progress(self) -> MissionProgress:
        """Return number and state of the mission, as PX4 names them."""
        mode = _MODE_ACTIVE if self._is_flown else _MODE_SUSPENDED
        if not self.items or self.problem is not None:
            state = mavlink.MISSION_STATE_NO_MISSION
        elif self._is_complete:
            state = mavlink.MISSION_STATE_COMPLETE
        elif self._is_flown:
            state = mavlink.MISSION_STATE_ACTIVE
        elif self._last_reached is not None or self.current > 0:
            state = mavlink.MISSION_STATE_PAUSED
        else:
            state = mavlink.MISSION_STATE_NOT_STARTED
        return MissionProgress(self.current, len(self.items), state, mode)

    def take_reached(self) -> tuple[int, ...]:
        """Return the items reached since the last call."""
        reached, self._reached = tuple(self._reached), []
        return reached

    def reached_again(self) -> int | None:
        """Return the item reached last, some times."""
        if self._last_reached is None or self._reached_left == 0:
            return None
        self._reached_left -= 1
        return self._last_reached

    def _begin_at(self, number: int) -> None:
        self.current = number
        self._is_complete = False
        self._last_reached = None
        self.revision += 1
        self.changes += 1


def _as_in_file(item: MissionItem, number: int) -> FileItem:
    """Return an item as mission files have it: places in deg, None for what is not given."""
    x, y = (None if value == UNKNOWN else float(value) for value in (item.x, item.y))
    if item.frame != Frame.MISSION:
        x, y = (None if value is None else value * 1e-7 for value in (x, y))
    given = [
        None if value is None or math.isnan(value) else value
        for value in (item.param1, item.param2, item.param3, item.param4, x, y, item.z)
    ]
    return FileItem(f"item {number}", number, item.frame, item.command, tuple(given), item.autocontinue)


def _refusal(error: ItemError, what: str) -> MissionAnswer:
    """Return the refusal of an upload, by the field that was wrong."""
    if error.field.startswith("param "):
        result = mavlink.MAV_MISSION_INVALID_PARAM1 - 1 + int(error.field[6])
    else:
        result = _RESULTS[error.field]
    return MissionAnswer(result, f"{what} refused: {error}")
