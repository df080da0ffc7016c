"""The plans that a ground has uploaded to an aircraft, and how far its flight has come with the mission."""

from collections.abc import Callable, Sequence
from typing import Protocol

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.answer import Answer, denied
from gcs.mavlink.services.mission_item import MissionItem, PlanType, opaque_id
from gcs.mavlink.services.mission_store import TAKEN, MissionAnswer, MissionProgress

_REACHED_REPEATS = 10
"""PX4 says so often again which item was reached."""
_MODE_ACTIVE, _MODE_SUSPENDED = 1, 2
"""Whether a mode is active that flies the mission: ``mission_mode`` of MISSION_CURRENT."""
_INVALID = {
    "frame": mavlink.MAV_MISSION_UNSUPPORTED_FRAME,
    "command": mavlink.MAV_MISSION_UNSUPPORTED,
    "latitude": mavlink.MAV_MISSION_INVALID_PARAM5_X,
    "longitude": mavlink.MAV_MISSION_INVALID_PARAM6_Y,
    "latitude, longitude": mavlink.MAV_MISSION_INVALID_PARAM5_X,
    "altitude": mavlink.MAV_MISSION_INVALID_PARAM7,
}
"""MAV_MISSION_RESULT by the field of an item that is wrong; of parameters by their number."""


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


class PlanRules(Protocol):
    """Which plans an aircraft takes."""

    def check_item(self, plan_type: PlanType, item: MissionItem, number: int) -> MissionAnswer:
        """Return whether an item can be taken by itself."""

    def check_plan(self, plan_type: PlanType, items: Sequence[MissionItem]) -> MissionAnswer:
        """Return whether a whole plan can be taken."""

    def why_unflyable(self, items: Sequence[MissionItem]) -> str | None:
        """Return why a mission that was taken cannot be started; None if it can, or there is none."""


class Plans:
    """A :class:`.MissionStore` of what the ground has uploaded, by the rules of the aircraft, and of the progress."""

    def __init__(self, flight: MissionFlight, rules: PlanRules) -> None:
        """``flight`` gets each new plan."""
        self._flight, self._rules = flight, rules
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
        """Return whether an item can be taken by itself."""
        return self._rules.check_item(plan_type, item, number)

    def accept(self, plan_type: PlanType, items: tuple[MissionItem, ...], current: int) -> MissionAnswer:
        """Take over a plan.

        As in PX4 a mission that was taken may be one that cannot be started, and :attr:`problem` says why; the same
        mission once more changes nothing.
        """
        if not (checked := self._rules.check_plan(plan_type, items)).is_accepted:
            return checked
        is_mission = plan_type == PlanType.MISSION
        problem = self._rules.why_unflyable(items) if is_mission else None
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


def refusal(field: str, text: str, what: str) -> MissionAnswer:
    """Return the refusal of an upload, by the ``field`` that was wrong, of ``what`` was uploaded."""
    number = mavlink.MAV_MISSION_INVALID_PARAM1 - 1 + int(field[6]) if field.startswith("param ") else _INVALID[field]
    return MissionAnswer(number, f"{what} refused: {text}")
