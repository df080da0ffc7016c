"""Alarms of a delivery: a landing place that is taken, and grippers that did not do what was commanded."""

from gcs.flight.alarms import Severity
from gcs.flight.flight import Flight
from gcs.flight.ground_legs import GroundLegs
from gcs.flight.monitor_step import MonitorStep, Scope, ScopedAlarm


class DeliveryAlarm(ScopedAlarm):
    """Alarms of :class:`Delivery`; in ``meaning``, names in braces are fields of ``MonitorSettings``."""

    # fmt: off
    LANDING_PLACE_TAKEN = (Scope.IN_AIR, Severity.WARNING, "clear the landing place",
        "something on the obstacle map is where the formation is to land: it waits where the sensors see the place, "
        "and lands once it is free")
    UNLOADING_FAILED = (Scope.ALWAYS, Severity.WARNING, "check the gripper",
        "the payload unit does not accept the command to a gripper; or the payload's mass, {mass_time:g} s after the "
        "take-off, is more than {mass_error:.0%} off the one expected, and fits better without what a gripper was to "
        "release or grab")
    # fmt: on


class Delivery:
    """The detector of these, beside those of :func:`gcs.flight.detectors.detectors`."""

    def __init__(self, flight: Flight) -> None:
        self._flight, self._settings = flight, flight.mission.system.flight.monitor
        self._legs: GroundLegs | None = None
        self._weighed = False
        """Whether the payload has been weighed since."""
        self._reported = 0
        """How many of their refusals have been reported."""
        self._moved: frozenset[int] = frozenset()
        """Grippers that were commanded before, in flights too short to weigh the payload."""

    def __call__(self, step: MonitorStep) -> None:
        """Raise the alarms of one control step."""
        flight = self._flight
        place = flight.landing_place
        if place.is_waited_for and place.taken is not None:
            text = f"landing place taken by {place.taken.name}: waits"
            step.raise_alarm(place.taken.name, DeliveryAlarm.LANDING_PLACE_TAKEN, text)
        if (legs := flight.ground_legs) is None:
            return
        if legs is not self._legs:
            if self._legs is not None and not self._weighed:
                self._moved |= self._legs.moved
            self._legs, self._reported, self._weighed = legs, 0, False
        new, self._reported = legs.refusals[self._reported :], len(legs.refusals)
        if new:
            step.raise_alarm("payload", DeliveryAlarm.UNLOADING_FAILED, f"{self._where}: {'; '.join(new)}")
        flown = flight.flown.trajectory
        if step.in_air and flown is not None and not self._weighed:
            self._weighed = step.time - flown.start >= self._settings.mass_time
            if self._weighed:
                self._weigh(step, legs)

    @property
    def _where(self) -> str:
        return f"stop {self._flight.landings}" if self._flight.landings else "on the pad"

    def _weigh(self, step: MonitorStep, legs: GroundLegs) -> None:
        """Compare the payload's mass with the one expected, if the grippers were to change it."""
        cargo, mass = self._flight.cargo, self._flight.control.controller.load.payload_mass
        expected = cargo.mass
        failed = cargo.failed(self._moved | legs.moved, mass, self._settings.mass_error)
        self._moved = frozenset()
        if not failed:
            return
        did = [f"gripper {number} did not {'grab' if number in cargo.held else 'release'}" for number in failed]
        cargo.undo(failed)
        text = f"{self._where}: the payload weighs {mass:.1f} kg, expected {expected:.1f} kg: {', '.join(did)}"
        step.raise_alarm("payload", DeliveryAlarm.UNLOADING_FAILED, text)
