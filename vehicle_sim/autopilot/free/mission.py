"""A free vehicle's mission: its items in the local frame, and how far it has come."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from enum import Enum, auto

from idc_controller.rotations_float import Vector


class Action(Enum):
    """What an item of a mission does."""

    TAKE_OFF = auto()
    FLY = auto()
    LAND = auto()
    RETURN = auto()
    SPEED = auto()
    JUMP = auto()
    NOTHING = auto()
    """Passed over: cameras and what else the vehicle does not have."""


@dataclass(frozen=True)
class MissionStep:
    """One item. ``position`` NED (m), NaN: where it is; ``yaw`` (rad), NaN: ahead; NaN of others: by parameter.

    ``hold`` (s) at the place, infinite: for ever; ``radius`` (m) of acceptance; ``speed`` (m/s); ``target`` and
    ``repeat`` of a jump.
    """

    action: Action
    position: Vector = (math.nan, math.nan, math.nan)
    hold: float = 0.0
    radius: float = math.nan
    yaw: float = math.nan
    speed: float = math.nan
    target: int = 0
    repeat: int = 0


def _ignore(index: int) -> None:
    pass


@dataclass(eq=False)
class Mission:
    """Steps and progress: ``current`` is flown next, and is kept when the mission is paused."""

    steps: tuple[MissionStep, ...] = ()
    current: int = 0
    finished: bool = False
    on_reached: Callable[[int], None] = _ignore
    """Called with the index of each item that has been done."""
    _jumps: dict[int, int] = field(default_factory=dict)

    @property
    def step(self) -> MissionStep:
        """The current step."""
        return self.steps[self.current]

    def restart(self, first: int = 0) -> None:
        """Begin at item ``first``, and make all jumps anew."""
        self.current, self.finished = first, False
        self._jumps.clear()

    def from_item(self, first: int) -> "Mission":
        """Return the same mission, not begun yet, from item ``first`` on."""
        return Mission(self.steps, first, on_reached=self.on_reached)

    def done(self) -> None:
        """Pass on from the current step, which has been done; the last one stays current."""
        index, step = self.current, self.step
        self.on_reached(index)
        following = index + 1
        if step.action is Action.JUMP:
            made = self._jumps.get(index, 0)
            if step.repeat < 0 or made < step.repeat:
                self._jumps[index] = made + 1
                following = step.target
        if following >= len(self.steps):
            self.finished = True
        else:
            self.current = following
