"""Commands to the payload unit: its grippers, as MAV_CMD_DO_GRIPPER and MAV_CMD_DO_WINCH command them.

Every vehicle forwards them, so that one command may come as often as there are vehicles: it is carried out once.
"""

from collections import deque
from collections.abc import Callable, Mapping
from functools import partial, update_wrapper
from typing import NamedTuple

import pymavlink.dialects.v20.ardupilotmega as mavlink

from gcs.mavlink.services.aircraft import Control
from gcs.mavlink.services.answer import ACCEPTED, UNSUPPORTED, Answer, denied
from gcs.mavlink.services.dispatcher import Command, CommandHandler, Request
from gcs.mavlink.services.streams import whole
from vehicle_sim.world.grippers import Grippers

_ALL = 0
_GRIPPERS_MAX = 6
_GRIPPER_ACTIONS = {mavlink.GRIPPER_ACTION_RELEASE: False, mavlink.GRIPPER_ACTION_GRAB: True}
_WINCH_ACTIONS = {mavlink.WINCH_DELIVER: False, mavlink.WINCH_LOAD_PAYLOAD: True}
_COPY_TIME = 1.0
"""Time (s) in which the same command by another vehicle is a copy: links that are flown differ by a tenth of that."""
_REMEMBERED = 8
"""Commands whose copies are known."""


class _Done(NamedTuple):
    """A command that was carried out: who sent it, what it was, when (s), and by which vehicles it has come."""

    sender: tuple[int, int]
    contents: tuple[int, int, bool]
    time: float
    vehicles: set[int]


class PayloadUnit:
    """One for the team."""

    def __init__(self, grippers: Grippers, is_armed: Callable[[], bool]) -> None:
        """``is_armed``: whether any vehicle is."""
        self._grippers, self._is_armed = grippers, is_armed
        self._done: deque[_Done] = deque(maxlen=_REMEMBERED)

    def handlers(self, vehicle: int, control: Control) -> Mapping[int, CommandHandler]:
        """Return what carries out the commands that a ``vehicle`` (its system id) under ``control`` forwards."""
        commands = mavlink.MAV_CMD_DO_GRIPPER, mavlink.MAV_CMD_DO_WINCH
        runs = self._do_gripper, self._do_winch
        return {
            number: update_wrapper(partial(run, vehicle, control), run)
            for number, run in zip(commands, runs, strict=True)
        }

    def _do_gripper(self, vehicle: int, control: Control, message: Command, request: Request) -> Answer:
        """Release (param2 0) or grab (1) the cargo of a gripper (param1, 0: all); on the ground, rotors stopped."""
        if (action := whole(message.param2)) not in _GRIPPER_ACTIONS:
            return denied(f"Gripper denied: action {message.param2:g} is neither release (0) nor grab (1)", 2)
        return self._move(vehicle, control, message, request, grab=_GRIPPER_ACTIONS[action])

    def _do_winch(self, vehicle: int, control: Control, message: Command, request: Request) -> Answer:
        """Unload (param2 4, deliver) or load (7, load payload) the cargo of a gripper (param1, 0: all) likewise."""
        if (action := whole(message.param2)) not in _WINCH_ACTIONS:
            return UNSUPPORTED
        return self._move(vehicle, control, message, request, grab=_WINCH_ACTIONS[action])

    def _move(self, vehicle: int, control: Control, message: Command, request: Request, *, grab: bool) -> Answer:
        numbers = self._grippers.numbers
        gripper = whole(message.param1, _GRIPPERS_MAX + 1)
        what = "Loading" if grab else "Unloading"
        if gripper is None or gripper not in (_ALL, *numbers) or not numbers:
            there = f"grippers {', '.join(map(str, numbers))}" if numbers else "no gripper"
            return denied(f"{what} denied: no gripper {message.param1:g}, the payload has {there}", 1)
        if control.is_stranger(request.sender, request.now):
            return denied(f"{what} denied: another ground station is in control")
        if self._is_copy(vehicle, request, (message.command, gripper, grab)):
            return ACCEPTED
        if not self._grippers.is_on_ground:
            return denied(f"{what} denied: in the air")
        if self._is_armed() or not self._grippers.is_still:
            return denied(f"{what} denied: rotors are not stopped")
        for number in numbers if gripper == _ALL else (gripper,):
            self._grippers.move(number, grab=grab)
        sender = request.system, request.component
        self._done.append(_Done(sender, (message.command, gripper, grab), request.now, {vehicle}))
        return ACCEPTED

    def _is_copy(self, vehicle: int, request: Request, contents: tuple[int, int, bool]) -> bool:
        """Return whether a command that was carried out has come by another vehicle: each brings it once.

        A vehicle that brings it a second time has a new command, which changes nothing unless another came between.
        """
        sender = request.system, request.component
        for done in self._done:
            is_same = done.sender == sender and done.contents == contents
            if is_same and vehicle not in done.vehicles and request.now - done.time < _COPY_TIME:
                done.vehicles.add(vehicle)
                return True
        return False
