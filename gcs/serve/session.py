"""The team between flights and in flight: which ground station flies now, its mode, and what is to be reported."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import TYPE_CHECKING, Protocol

from gcs.flight.alarms import Alarm
from gcs.flight.failsafe import Failsafe
from gcs.flight.flight import Flight
from gcs.flight.ground_station import GroundStation
from gcs.flight.phase import CONTROLLED, Phase
from gcs.flight.reconfiguration import reconfigure
from gcs.mavlink import px4
from gcs.mission.model import Mission
from gcs.serve.orders import Orders, take_off_route
from gcs.serve.parameters import TAKEOFF_ALTITUDE

if TYPE_CHECKING:
    from gcs.config import SystemConfig

_RUN_DOWN = 2.0
"""s after disarming, for rotors and load to come to rest before the records of the flight are closed."""


class OpenFlight(Protocol):
    """A ground station with its records."""

    @property
    def station(self) -> GroundStation:
        """The ground station."""

    def close(self) -> str:
        """Close the records; return the STATUSTEXT of their flight, empty: there are none."""


class TeamSession:
    """One ground station after the other: one that waits, then one for each flight, from arming to disarming.

    Times are the ground's (s), positions NED (m).
    """

    def __init__(self, world: Mission, open_flight: Callable[[Mission, bool], OpenFlight]) -> None:
        """``open_flight`` opens a flight of a mission, with records or without."""
        self.world = replace(world, reference=take_off_route(world.system, (0.0, 0.0), TAKEOFF_ALTITUDE))
        """System, home and obstacles of every flight, and the fence of the plans that were uploaded."""
        self._open_flight = open_flight
        self._opened = open_flight(world, False)
        self._wait()
        self.orders = Orders(self)
        """What the flight is ordered to do."""
        self.mode = px4.MODE_HOLD
        """The custom mode that was ordered last."""
        self.pad = 0.0, 0.0
        """Where the payload stood when it was armed last, north and east."""
        self.changes = 0
        """Rises with every change that is to be reported."""
        self.notices: list[str] = []
        """STATUSTEXTs that have not been sent yet."""
        self._alarms = 0
        self._cleared_until = math.inf
        self._phase = Phase.CONNECT
        self._now = 0.0
        self.run_down = -math.inf
        """Time until which the records of a flight that has ended remain open (s); -inf: none has."""
        self.closing = False
        """True if no further flight is to begin."""
        self.is_interrupted = False
        """True if it was closed in flight."""
        self.last_reason = ""
        """Why the last flight did not begin; empty: it did, or none was tried."""

    @property
    def station(self) -> GroundStation:
        """The ground station that is connected with the vehicles now."""
        return self._opened.station

    @property
    def flight(self) -> Flight:
        """Its flight."""
        return self.station.flight

    @property
    def in_air(self) -> bool:
        """True from spool-up until the rotors have stopped."""
        return self.flight.phase in CONTROLLED or self.flight.phase is Phase.AUTONOMOUS_LANDING

    @property
    def is_armed(self) -> bool:
        """True while vehicles are armed, or about to be."""
        return self.flight.may_arm and not self.flight.ended

    @property
    def ended(self) -> bool:
        """True if it is closing and the payload is on the ground."""
        return self.closing and not self.is_armed and not self._now < self.run_down

    # Orders

    def arm(self) -> None:
        """Begin a flight: connect anew, check, arm, and wait for a take-off. Only when the flight before is ready."""
        north, east, _ = self.flight.system.preflight.payload.tolist()
        self.pad = north, east
        self._opened.close()
        self._open(recorded=True)
        self.flight.may_take_off = False
        self._alarms, self._cleared_until = 0, math.inf
        self.changes += 1

    def configure(self, system: SystemConfig) -> None:
        """Have other settings: at once, or from the next legs on, or from the next arming; as the flight takes them."""
        before = self.world.system.motion.speed
        self.world = replace(self.world, system=system)
        reconfigure(self.flight, system)
        self.orders.configure(before)

    def disarm(self) -> None:
        """Stay on the ground, with stopped rotors; a mission ends there."""
        if self.orders.is_at_stop:
            self.orders.forget_mission()
            self.notices.append("Mission ended on the ground")
        self.flight.stand_down()

    def raise_failsafe(self, now: float, failsafe: Failsafe, reason: str) -> None:
        """Land what is in the air, and begin no flight any more."""
        self.closing = True
        if self.is_armed:
            self.is_interrupted = True
            self.station.raise_failsafe(now, failsafe, reason)

    def enter(self, mode: int) -> None:
        """Report a custom mode from now on."""
        self.mode = mode
        self.changes += 1

    def _open(self, *, recorded: bool) -> None:
        """Open a flight of the team as the one before has left it: its cargo, place, and steps of attitudes."""
        before = self.flight
        self._opened = self._open_flight(self.world, recorded)
        self.flight.cargo = before.cargo
        steps = self.flight.control.estimator.attitude_steps
        steps.total[:] = before.control.estimator.attitude_steps.total
        self.flight.system.preflight.landed = before.system.preflight.landed or not math.isnan(before.takeoff_time)

    def _wait(self) -> None:
        self.flight.may_arm = self.flight.may_take_off = False

    # Time

    def step(self, now: float) -> None:
        """Follow the ground station: report alarms, end what has ended, disarm what waits for too long."""
        flight, self._now = self.flight, now
        self._take_alarms(flight)
        if flight.phase is not self._phase:
            self._phase = flight.phase
            self.changes += 1
        if flight.phase is Phase.ARM and not flight.may_take_off and flight.system.team.armed:
            if self._cleared_until == math.inf:
                self._cleared_until = now + px4.PREFLIGHT_DISARM
            elif now > self._cleared_until:
                self.notices.append(f"Disarmed: no take-off for {px4.PREFLIGHT_DISARM:g} s")
                flight.stand_down()
        if self.mode == px4.MODE_TAKEOFF and flight.phase is Phase.HOLD:
            self.enter(px4.MODE_HOLD)
        if flight.ended and flight.may_arm and self.run_down == -math.inf:
            self.run_down = now + _RUN_DOWN
        if flight.ended and not self.closing and now >= self.run_down:
            self._end(flight)

    def _take_alarms(self, flight: Flight) -> None:
        alarms: list[Alarm] = flight.failsafes.alarms.alarms
        for alarm in alarms[self._alarms :]:
            if flight.may_arm:
                self.notices.append(f"{alarm.source}: {alarm.text or alarm.code.code}")
        self._alarms = len(alarms)

    def _end(self, flight: Flight) -> None:
        """Close the records of a flight that has ended, and wait for the next one."""
        text = self._opened.close()
        if flight.may_arm:
            self.notices.append(text or "Flight ended")
        self.last_reason, self.run_down = flight.reason, -math.inf
        self._open(recorded=False)
        self._wait()
        self.orders.reset()
        self._alarms = 0
        self.enter(px4.MODE_HOLD)

    def close(self) -> str:
        """Close the records."""
        return self._opened.close()
