"""What a flight flies of its mission: the legs, the trajectory along them, and the ways off it that are ordered."""

import math
from collections.abc import Callable, Iterator
from itertools import chain

import numpy as np

from gcs.flight.control_loop import ControlLoop
from gcs.flight.landing_place import LandingPlace
from gcs.flight.mission_legs import MissionLeg, MissionLegs
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.flight.phase import Phase
from gcs.mission.model import Mission
from gcs.mission.route import Position
from idc_controller.arrays import Array
from idc_controller.trajectory.trajectory import Trajectory


class FlownMission:
    """Legs that are passed, flown, and still to come, take-off by take-off. Times are the team's (s).

    What is flown changes only before the touchdown, and between two control steps: what is followed comes to rest
    within the limits first.
    """

    def __init__(self, mission: Mission, control: ControlLoop, landing_place: LandingPlace) -> None:
        self._control, self._guidance, self._landing_place = control, control.controller.guidance, landing_place
        self.legs = MissionLegs.of(mission)
        """Those that are still to come."""
        self.trajectory: MissionTrajectory | None = None
        """Of this flight, from the beginning of its climb until the rotors spool up for the next; else None."""
        self.is_redirected = False
        """True if orders in flight have taken the place of the mission."""
        self._has_landed = False
        """True from the touchdown until the rotors spool up again."""
        self._passed: list[str] = []
        """Sources of the legs before the trajectory that is flown, in the order of the flight."""
        self._home: Array | None = None
        """Where the payload stood before the first take-off (3,)."""

    # Where it is

    @property
    def in_air(self) -> bool:
        """True from the beginning of a climb to the touchdown."""
        return self.trajectory is not None and not self._has_landed

    @property
    def expected_end(self) -> float:
        """The end of the trajectory (s); inf while that is not known."""
        return self.trajectory.trajectory.end if self.trajectory is not None else math.inf

    @property
    def is_held(self) -> bool:
        """True from :meth:`hold` until other legs are flown."""
        return self.trajectory is not None and self.trajectory.is_held

    def progress(self, time: float) -> float:
        """Return the progress (s) along the trajectory."""
        return self._guidance.progress(time)

    def phase(self, time: float) -> Phase:
        """Return the phase of a flight in the air."""
        assert self.trajectory is not None
        return Phase(self.trajectory.phase(self.progress(time)))

    def until_landing(self, time: float, within: float) -> float:
        """Return the time (s) to the final descent of a flight in the air; zero in it, inf where that is farther.

        ``within`` (s): as far as each control step reads the trajectory. Who shows the mission may have read on.
        """
        assert self.trajectory is not None
        until = self.trajectory.landing_from - self.progress(time)
        return max(until, 0.0) if until <= within else math.inf

    def descent(self, time: float) -> tuple[float, Trajectory]:
        """Return the progress (s) along the trajectory of a flight that lands, and that trajectory."""
        assert self.trajectory is not None
        return self.progress(time), self.trajectory.trajectory

    def position(self, time: float) -> Position:
        """Return where the payload is planned to be in the air (NED, m)."""
        assert self.trajectory is not None
        north, east, down = self.trajectory.trajectory.position(self.progress(time)).tolist()
        return north, east, down

    def reference(self, times: Array) -> tuple[Array, Array]:
        """Return position and velocity (K, 3) of the payload at ``times`` (K,), at the progress made by then."""
        assert self.trajectory is not None
        return self.trajectory.reference(np.array([self.progress(t) for t in times.tolist()]))

    def passed(self, time: float) -> list[str]:
        """Return the sources of the legs that were done by ``time``, in their order, each as often as it has legs."""
        if self.trajectory is None or self._has_landed:
            return self._passed
        return [*self._passed, *self.trajectory.passed(self.progress(time))]

    def next_source(self, time: float) -> str | None:
        """Return the source of what is flown to, or is next; None: nothing, or it holds for good at the last."""
        if self.trajectory is None or self._has_landed:
            return self.legs.next_source
        return self.trajectory.next_source(self.progress(time))

    # From ground to ground

    def begin(self, mission: Mission) -> None:
        """Fly ``mission`` with the next take-off."""
        self.legs = MissionLegs.of(mission)

    def carried_out(self, source: str) -> None:
        """Take a leg that was carried out on the ground."""
        self._passed.append(source)

    def spool_up(self) -> None:
        """Forget the trajectory of the flight before; :meth:`climb` follows."""
        self.trajectory, self._has_landed = None, False

    def climb(self, mission: Mission, time: float, pad: Array) -> None:
        """Take off from the ``pad`` (3,) with the next legs of ``mission``."""
        self._home = pad if self._home is None else self._home
        self.trajectory = MissionTrajectory(mission, pad, time, self.legs.flight(), self._home)

    def touch_down(self, time: float) -> None:
        """Take the landing as done."""
        assert self.trajectory is not None
        self._passed = [*self.passed(time), self.trajectory.landing]
        self._has_landed = True

    # Ways off the trajectory

    def watch_landing_place(self, time: float) -> None:
        """Wait before a landing place that is taken; once a control step."""
        if self.trajectory is not None:
            self._landing_place.watch(time, self.trajectory, self._guidance)

    def brake_and_land(self, time: float) -> None:
        """Come to rest, and land there; without effect before the climb."""
        if self.trajectory is not None:
            self._leave(time, self.trajectory.brake_and_land)

    def return_home(self, time: float) -> None:
        """Come to rest, then fly home and land there; without effect before the climb."""
        if self.trajectory is not None:
            self._leave(time, self.trajectory.return_home)

    def hold(self, time: float) -> None:
        """Come to rest, and hold there. Only as :meth:`fly`."""
        if (flown := self.trajectory) is None or flown.is_held:
            return
        mission_progress = self.progress(time)
        self._leave(time, lambda followed, progress: flown.hold(followed, progress, mission_progress))

    def remaining(self) -> Iterator[MissionLeg]:
        """Return what remains of the legs that were flown before :meth:`hold`."""
        assert self.trajectory is not None
        return chain(self.trajectory.remaining(), self.legs)

    def resume(self, time: float, speed: float) -> None:
        """Go on with the legs that were flown before :meth:`hold`, none faster than ``speed`` (m/s)."""
        self._fly_on(time, self.remaining(), speed)

    def fly(self, time: float, legs: Iterator[MissionLeg], speed: float) -> None:
        """Come to rest, then fly ``legs`` from there, none faster than ``speed`` (m/s).

        They end with a hold or a landing, after which others may follow. Only before the landing, and while no failsafe
        lands the payload.
        """
        self.is_redirected = True
        self._fly_on(time, legs, speed)

    def _fly_on(self, time: float, legs: Iterator[MissionLeg], speed: float) -> None:
        assert self.trajectory is not None
        self._passed, self.legs = self.passed(time), MissionLegs(legs)
        go_on = self.trajectory.go_on
        self._leave(time, lambda followed, progress: go_on(followed, progress, self.legs.flight(), speed))

    def _leave(self, time: float, change: Callable[[Trajectory, float], None]) -> None:
        """Change what is flown, by a function of the trajectory that is followed and of the progress (s) along it."""
        assert self.trajectory is not None
        self._landing_place.waiting_since = math.inf
        self._guidance.speed_limit = math.inf  # of what was flown
        trajectory, rest = self.trajectory.trajectory, self._control.resting_place
        followed, progress = self._guidance.stopping_trajectory(time, trajectory, rest)
        change(followed, progress)
        self._guidance.restart(time, progress)
