"""A vehicle without a payload as the MAVLink services command it."""

import math
from collections.abc import Callable, Sequence

from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Orbit, Place, Reposition, Turn
from gcs.mavlink.services.answer import ACCEPTED, Answer, denied, rejected_for_now
from gcs.mavlink.services.local_frame import LocalFrame
from gcs.mavlink.services.mission_item import MissionItem
from idc_controller.rotations_float import Vector
from vehicle_sim.autopilot.free.autopilot import FreeAutopilot
from vehicle_sim.autopilot.free.circling import Heading
from vehicle_sim.autopilot.free.mission import Mission
from vehicle_sim.autopilot.free.orbit import begin_orbit
from vehicle_sim.mavlink.aircraft import SimulatedAircraft
from vehicle_sim.mavlink.control_owner import ControlOwner
from vehicle_sim.mavlink.fence_areas import fence_of, rally_points_of
from vehicle_sim.mavlink.mission_steps import steps_of


class FreeAircraft(SimulatedAircraft):
    """Does what PX4 does; places and altitudes become those of the local frame here."""

    _autopilot: FreeAutopilot

    def __init__(self, autopilot: FreeAutopilot, owner: ControlOwner, frame: LocalFrame) -> None:
        super().__init__(autopilot, owner)
        self._frame = frame
        self._items: tuple[MissionItem, ...] = ()

    modes = (
        px4.MODE_TAKEOFF, px4.MODE_HOLD, px4.MODE_MISSION, px4.MODE_RETURN, px4.MODE_LAND, px4.MODE_OFFBOARD,
        px4.MODE_POSCTL, px4.MODE_ALTCTL,
    )  # fmt: skip
    obeys_broadcasts = True

    def take_off(self, altitude: float, now: float) -> Answer:
        """Take off to ``altitude`` (m above mean sea level; NaN: the parameter's height above home)."""
        return self._autopilot.take_off(altitude - self._frame.altitude + self._autopilot.state.ground, now)

    def reposition(self, goal: Reposition, now: float) -> Answer:
        """Fly to a place and hold there."""
        return self._autopilot.go_to(self._local(Place(*goal[:3])), goal.yaw, goal.speed, now)

    def _local(self, place: Place) -> Vector:
        """Return a place (NED, m), of which what is not given is NaN."""
        if not (math.isfinite(place.latitude) and math.isfinite(place.longitude)):
            return math.nan, math.nan, self._frame.altitude - place.altitude
        altitude = place.altitude
        if math.isnan(altitude):
            estimate = self._autopilot.state.estimate
            altitude = self._frame.altitude - (0.0 if estimate is None else estimate.position[2])
        return self._frame.local(place.latitude, place.longitude, altitude)

    def orbit(self, orbit: Orbit, now: float) -> Answer:
        """Fly on a circle."""
        centre, heading = self._local(orbit.centre), Heading(orbit.heading)
        return begin_orbit(self._autopilot.state, centre, orbit.radius, orbit.speed, heading, orbit.angle)

    def change_speed(self, speed: float, now: float) -> Answer:
        """Fly with another horizontal speed (m/s) from now on."""
        return self._autopilot.change_speed(speed, now)

    def turn(self, turn: Turn, now: float) -> Answer:
        """Change the heading where it holds."""
        return self._autopilot.turn(turn.angle, turn.rate, turn.direction, turn.is_relative)

    def set_home(self, place: Place | None, now: float) -> Answer:
        """Return to a ``place`` from now on (None: to where it is), and have the mission's altitudes above it."""
        answer = self._autopilot.set_home(None if place is None else self._frame.local(*place))
        if answer == ACCEPTED:
            self._autopilot.replace_steps(steps_of(self._items, self._frame, self._autopilot.home))
        return answer

    def start_mission(self, first: int, now: float) -> Answer:
        """Fly the mission from item ``first`` on; as PX4 it arms for it."""
        if not 0 <= first < max(len(self._items), 1):
            return denied(f"Mission denied: there is no item {first}")
        state = self._autopilot.state
        before, state.mission = state.mission, state.mission.from_item(first)
        answer = self._autopilot.enter_mode(px4.MODE_MISSION, now)
        if answer != ACCEPTED:
            state.mission = before
            return answer
        return self._autopilot.arm(now)

    def pause(self, now: float) -> Answer:
        """Hold; the mission's current item stays."""
        return self._autopilot.enter_mode(px4.MODE_HOLD, now)

    def resume(self, now: float) -> Answer:
        """Go on with the mission that was paused."""
        if not self._items:
            return rejected_for_now("Mission denied: no mission")
        return self._autopilot.enter_mode(px4.MODE_MISSION, now)

    # The mission

    def take_mission(self, items: Sequence[MissionItem], current: int, on_reached: Callable[[int], None]) -> Answer:
        """Have another mission, of which ``current`` is flown first; ``on_reached`` is called with each item done."""
        if items and not 0 <= current < len(items):
            return denied(f"Mission denied: there is no item {current}")
        self._items = tuple(items)
        self._autopilot.take_mission(
            Mission(steps_of(self._items, self._frame, self._autopilot.home), current, on_reached=on_reached)
        )
        return ACCEPTED

    @property
    def current_item(self) -> int:
        """The item of the mission that is flown, or will be."""
        return self._autopilot.state.mission.current

    @property
    def mission_finished(self) -> bool:
        """Return True if all items have been done."""
        return self._autopilot.state.mission.finished

    @property
    def mission_active(self) -> bool:
        """Return True if it flies the mission."""
        return self._autopilot.armed and self._autopilot.mode == px4.MODE_MISSION

    def set_current_item(self, index: int, now: float) -> Answer:
        """Go on with item ``index``."""
        if not 0 <= index < len(self._items):
            return denied(f"Mission denied: there is no item {index}")
        self._autopilot.set_current_item(index)
        return ACCEPTED

    def take_fence(self, items: Sequence[MissionItem]) -> None:
        """Have another fence from now on."""
        self._autopilot.state.fence = fence_of(items, self._frame)

    def take_rally_points(self, items: Sequence[MissionItem]) -> None:
        """Have other rally points from now on."""
        self._autopilot.state.rally_points = rally_points_of(items, self._frame, self._autopilot.home)
