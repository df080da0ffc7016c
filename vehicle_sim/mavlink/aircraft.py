"""A vehicle as the MAVLink services command it; what one that carries a payload with others refuses."""

from collections.abc import Sequence

from gcs.mavlink import px4
from gcs.mavlink.services.aircraft import Orbit, Place, Reposition, Sender, Turn
from gcs.mavlink.services.answer import Answer, denied
from vehicle_sim.autopilot.autopilot import Autopilot
from vehicle_sim.autopilot.modes import team_only
from vehicle_sim.mavlink.control_owner import ControlOwner


class SimulatedAircraft:
    """What any simulated vehicle does when it is commanded; which modes it has is its kind's."""

    modes: Sequence[int]
    obeys_broadcasts: bool

    def __init__(self, autopilot: Autopilot, owner: ControlOwner) -> None:
        self._autopilot = autopilot
        self._owner = owner

    def arming_problem(self, now: float) -> str | None:
        """See :meth:`.Autopilot.arming_problem`."""
        return self._autopilot.arming_problem(now)

    def arm(self, now: float, force: bool = False) -> Answer:
        """See :meth:`.Autopilot.arm`."""
        return self._autopilot.arm(now, force)

    def disarm(self, sender: Sender, now: float, force: bool = False) -> Answer:
        """See :meth:`.Autopilot.disarm`."""
        return self._autopilot.disarm(force)

    def enter_mode(self, custom_mode: int, sender: Sender, now: float) -> Answer:
        """Enter a mode; OFFBOARD on the set-points of ``sender``."""
        if custom_mode == px4.MODE_OFFBOARD:
            return self._owner.enter_offboard(sender, now)
        return self._autopilot.enter_mode(custom_mode, now)


class CoupledAircraft(SimulatedAircraft):
    """A vehicle on a payload: flown in OFFBOARD by the ground in control; what would tear the team apart is denied."""

    modes = (px4.MODE_HOLD, px4.MODE_LAND, px4.MODE_OFFBOARD, px4.MODE_POSCTL, px4.MODE_ALTCTL, px4.MODE_MANUAL)
    """Those of sticks on the ground only."""
    obeys_broadcasts = False
    """One that missed the command would be left behind by the others."""

    def disarm(self, sender: Sender, now: float, force: bool = False) -> Answer:
        """Disarm; in the air only for the ground that flies it, or did last: its silence gives no other the right."""
        if self._autopilot.is_flying and self._owner.owner not in (None, sender):
            return denied("Disarming denied: another ground flies it")
        return super().disarm(sender, now, force)

    def take_off(self, altitude: float, now: float) -> Answer:
        """Refuse."""
        return team_only("Takeoff")

    def reposition(self, goal: Reposition, now: float) -> Answer:
        """Refuse."""
        return team_only("Reposition")

    def change_speed(self, speed: float, now: float) -> Answer:
        """Refuse."""
        return team_only("Speed change")

    def turn(self, turn: Turn, now: float) -> Answer:
        """Refuse."""
        return team_only("Turn")

    def orbit(self, orbit: Orbit, now: float) -> Answer:
        """Refuse."""
        return team_only("Orbit")

    def set_home(self, place: Place | None, now: float) -> Answer:
        """Refuse: home is the origin of the local frame."""
        return denied("Home denied: it is the origin of the simulated world; vehicle-sim --mission sets it")

    def start_mission(self, first: int, now: float) -> Answer:
        """Refuse."""
        return team_only("Mission")

    def pause(self, now: float) -> Answer:
        """Refuse."""
        return team_only("Pause")

    def resume(self, now: float) -> Answer:
        """Refuse."""
        return team_only("Mission")
