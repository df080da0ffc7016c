"""Mission, fence and rally points of a vehicle: those of one that flies by itself, and none of one on a payload."""

import math
from collections.abc import Callable, Sequence
from typing import Protocol

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.answer import Answer, denied
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
_MODE_ACTIVE, _MODE_SUSPENDED = 1, 2
"""Whether a mode is active that flies the mission: ``mission_mode`` of MISSION_CURRENT."""
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


class MissionFlight(Protocol):
    """What flies a mission."""

    def take_mission(self, items: Sequence[MissionItem], current: int, on_reached: Callable[[int], None]) -> Answer:
        """Have another mission, of which ``current`` is flown first; ``on_reached`` is called with each item done."""

    def set_current_item(self, index: int, now: float) -> Answer:
        """Go on with item ``index``."""

    def take_fence(self, items: Sequence[MissionItem]) -> None:
        """Have another fence."""

    def take_rally_points(self, items: Sequence[MissionItem]) -> None:
        """Have other rally points."""

    @property
    def current_item(self) -> int:
        """The item of the mission that is flown, or will be."""

    @property
    def mission_finished(self) -> bool:
        """Whether all items have been done."""

    @property
    def mission_active(self) -> bool:
        """Whether the mode that flies the mission is active."""


class MissionPlans:
    """Plans of a vehicle that flies by itself: what the ground has uploaded, and how far the flight has come."""

    def __init__(self, home: Home, flight: MissionFlight) -> None:
        """``home`` is that from which the distances of the items are limited; ``flight`` gets each new mission."""
        self._home = FileHome(home.latitude, home.longitude, home.altitude)
        self._flight = flight
        self._plans: dict[PlanType, tuple[MissionItem, ...]] = dict.fromkeys(PlanType, ())
        self._ids = dict.fromkeys(PlanType, 0)
        self._reached: list[int] = []
        self._reached_left = 0
        self._last_reached: int | None = None
        self._changes = 0
        self._seen = self._flown()
        self.problem: str | None = None
        """Reason why the mission cannot be started; None if it can, or there is none."""

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

    @property
    def current(self) -> int:
        """Number of the item that is flown to."""
        return self._flight.current_item

    def reached(self, number: int) -> None:
        """Send that item ``number`` was reached."""
        self._reached.append(number)
        self._last_reached, self._reached_left = number, _REACHED_REPEATS
        self._changes += 1

    def _flown(self) -> tuple[int, bool, bool]:
        return self._flight.current_item, self._flight.mission_finished, self._flight.mission_active

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
        if identity == self._ids[plan_type] and items:
            return TAKEN
        if plan_type == PlanType.MISSION:
            answer = self._hand_over(() if problem else items, current)
            if answer.result != mavlink.MAV_RESULT_ACCEPTED:
                return MissionAnswer(mavlink.MAV_MISSION_ERROR, answer.text)
            self.problem = problem
        elif plan_type == PlanType.FENCE:
            self._flight.take_fence(items)
        else:
            self._flight.take_rally_points(items)
        self._plans[plan_type], self._ids[plan_type] = items, identity
        self._changes += 1
        return MissionAnswer(TAKEN.result, f"Mission cannot be started: {problem}" if problem else "")

    def set_current(self, number: int, now: float, *, reset: bool = False) -> Answer:
        """Choose the item to be flown to."""
        if not number < len(self.items):
            return denied(f"Mission item denied: {number} of {len(self.items)} items")
        if self.problem:
            return denied(f"Mission item denied: {self.problem}")
        return self._hand_over(self.items, number) if reset else self._flight.set_current_item(number, now)

    def changes(self) -> int:
        """Return a number that rises with every change."""
        if (flown := self._flown()) != self._seen:
            self._seen = flown
            self._changes += 1
        return self._changes

    def progress(self) -> MissionProgress:
        """Return number and state of the mission, as PX4 names them."""
        current, is_finished, is_active = self._flown()
        if not self.items or self.problem:
            state = mavlink.MISSION_STATE_NO_MISSION
        elif is_finished:
            state = mavlink.MISSION_STATE_COMPLETE
        elif is_active:
            state = mavlink.MISSION_STATE_ACTIVE
        elif self._last_reached is not None or current > 0:
            state = mavlink.MISSION_STATE_PAUSED
        else:
            state = mavlink.MISSION_STATE_NOT_STARTED
        return MissionProgress(current, len(self.items), state, _MODE_ACTIVE if is_active else _MODE_SUSPENDED)

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

    def _hand_over(self, items: tuple[MissionItem, ...], current: int) -> Answer:
        """Have a mission flown from item ``current`` on."""
        self._reached.clear()
        self._last_reached = None
        return self._flight.take_mission(items, current, self.reached)


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
