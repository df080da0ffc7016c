"""Phases of the flight as the simulator sees them, which start faults: the ground says nothing about them.

Armed state, commanded thrust, onboard holds and the payload's contact with the ground are those of the simulation. What
is flown between lift-off and touchdown follows from the mission: its trajectory, from the time at which the rotors have
spooled up. Where an obstacle or a failsafe holds the flight up, the phases of the trajectory begin as planned.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from itertools import chain, islice
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from gcs.mission.model import Mission
from idc_controller.arrays import Array

if TYPE_CHECKING:
    from gcs.flight.mission_legs import MissionLeg, MissionLegs
    from gcs.flight.mission_trajectory import MissionTrajectory

_PLANNED = frozenset({"climb", "fly", "hold", "land"})
_RISEN = 0.05  # m; height of the payload above its pad from which ground contact is a touchdown

_MOST_LEGS = 20_000
"""Of one flight: an endless one is not followed by another."""


class VehicleState(NamedTuple):
    """A vehicle: armed; with thrust commanded; on an onboard plan (stop, hold, descent) in place of set-points."""

    armed: bool
    driven: bool
    autonomous: bool


class PhaseObserver:
    """Times of the first entry into each phase of a flight of ``mission``, of the phases ``wanted`` only.

    Names are those of :attr:`gcs.mission.model.Fault.start_key`.
    """

    def __init__(self, mission: Mission, wanted: Collection[str]) -> None:
        self.entered: dict[str, float] = {}
        """Time of the entry into each phase (s)."""
        self._mission, self._wanted = mission, frozenset(wanted)
        self._rest: Array | None = None
        self._trajectory: MissionTrajectory | None = None
        self._driven: set[int] = set()
        self._risen = False
        self._legs: MissionLegs | None = None
        self._flown: Iterator[MissionLeg] = iter(())
        self._flight, self._over = 1, False

    @property
    def pending(self) -> frozenset[str]:
        """Phases wanted that have not been entered."""
        return self._wanted - self.entered.keys()

    def observe(
        self, now: float, vehicles: Collection[VehicleState], payload: Array, *, standing: bool
    ) -> dict[str, float]:
        """Return the phases entered since the last call, with their times (s).

        Args:
            now: time (s).
            vehicles: of the team, always in the same order.
            payload: true position (3,) of the payload (NED, m).
            standing: the payload touches pad or ground.
        """
        found = self._found(now, [*vehicles], payload, standing=standing) & self.pending
        new = dict.fromkeys(found, now)
        self.entered |= new
        return new

    def _found(self, now: float, vehicles: list[VehicleState], payload: Array, *, standing: bool) -> set[str]:
        armed = any(vehicle.armed for vehicle in vehicles)
        if self._over and armed:
            self._begin_flight(self._flight + 1)
        found = {"arm"} if armed else set()
        driven = {i for i, vehicle in enumerate(vehicles) if vehicle.armed and vehicle.driven}
        if self._trajectory is None and driven:
            self._begin_trajectory(now, payload.copy())
        if self._trajectory is not None and self._rest is not None:
            self._risen = self._risen or bool(self._rest[2] - payload[2] > _RISEN)
            found |= self._in_flight(now, self._trajectory, vehicles, driven, standing=standing)
            self._driven |= driven
            if standing and self._risen and not armed:
                self._over = True
                found.add("on_ground")
        return {phase if self._flight == 1 else f"{phase} {self._flight}" for phase in found}

    def _in_flight(
        self,
        now: float,
        trajectory: MissionTrajectory,
        vehicles: list[VehicleState],
        driven: set[int],
        *,
        standing: bool,
    ) -> set[str]:
        found = {"spool_up"}
        if now >= trajectory.start and any(key.split()[0] in _PLANNED for key in self.pending):
            trajectory.reference(np.array([now]))  # it is lazy: ends of its parts are known once they are reached
            found.add(trajectory.phase(now))
        if any(vehicle.armed and vehicle.autonomous for vehicle in vehicles):
            found.add("autonomous_landing")
        if standing and self._risen:
            found.add("spool_down")
        if standing and self._driven - driven:
            found.add("disarm")
        return found

    def _begin_flight(self, number: int) -> None:
        self._flight, self._over, self._risen = number, False, False
        self._rest, self._trajectory, self._driven = None, None, set()

    def _begin_trajectory(self, now: float, rest: Array) -> None:
        # Takes long to import, spent only where needed.
        from gcs.flight.mission_legs import MissionLegs
        from gcs.flight.mission_trajectory import MissionTrajectory

        self._legs = self._legs or MissionLegs.of(self._mission)
        # Those of the flight before, of which a lazy trajectory may have read none, and those on the ground after it.
        for _ in islice(chain(self._flown, self._legs.on_ground()), _MOST_LEGS):
            pass
        if not self._legs.takes_off:
            return
        spooled_up = now + self._mission.system.flight.takeoff_landing.spool_up_time
        self._rest, self._flown = rest, self._legs.flight()
        self._trajectory = MissionTrajectory(self._mission, rest, spooled_up, self._flown)
