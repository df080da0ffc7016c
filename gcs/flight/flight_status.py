"""Status of a flight for the operator, by what the ground knows. The flight is only read."""

from __future__ import annotations

import math
from collections import deque
from typing import NamedTuple

import numpy as np

from gcs.flight.control_loop import StepRecord
from gcs.flight.flight import Flight
from gcs.flight.mission_legs import MissionLegs
from gcs.flight.mission_trajectory import MissionTrajectory
from gcs.flight.phase import IN_AIR, Phase
from gcs.mavlink.vehicle_link import VehicleLink
from gcs.mission.flown_legs import End, flown_legs
from gcs.mission.model import Mission
from gcs.mission.route import Route, Stand
from idc_controller.geometry.formation import Formation
from idc_controller.geometry.obstacles import Region
from idc_controller.safety.separation import PredictedObstacles, separations

_LINK_WINDOW = 2.0
"""s; over which loss and rate of a link are taken at least."""
_ESTIMATE_AGE = 0.5
"""s; beyond which an estimate is not shown."""
_LONGEST = 1800.0
"""s; beyond which the end of a mission is not computed in advance."""


OK, WARNING, BAD = "green", "yellow", "red"
"""States of a figure, as the colours in which they are shown."""


class Figure(NamedTuple):
    """A figure with its unit, and its state; empty: there is no limit to it."""

    text: str
    state: str = ""


class FlightStatus:
    """Times, payload, clearance and links of one flight."""

    def __init__(self, flight: Flight) -> None:
        system = flight.mission.system
        self._flight, self._range = flight, system.range_sensor.range
        self._formation = formation = Formation(flight.control.controller.parameters)
        self._reach = float(np.hypot(*formation.hover_offsets[:, :2].T).max()) + formation.disc_radius
        self._planned = _planned_durations(flight.mission)
        """Of each flight, with what is done on the ground before it, from climb to touchdown (s)."""
        self._links = [_LinkStatus(flight, link) for link in flight.system.team.links]

    def times(self) -> tuple[float, float]:
        """Return time since take-off began, nan: not yet, and when touchdown is expected on that clock, inf: unknown.

        What remains of the mission is taken to go on at its own speed (s).
        """
        flight = self._flight
        time, mission, end = flight.time, flight.flown.trajectory, flight.flown.expected_end
        if mission is None or flight.phase is Phase.AUTONOMOUS_LANDING:
            return time - flight.takeoff_time, math.inf
        flown = flight.landings - (flight.phase not in IN_AIR)
        if not flight.reason:
            this, *others = self._planned[min(flown, len(self._planned) - 1) :]
            end = mission.start + this.in_air if math.isinf(end) else end
            end += sum(each.on_ground + each.in_air for each in others)
        remaining = max(end - flight.system.guidance.progress(time), 0.0)
        return time - flight.takeoff_time, time + remaining - flight.takeoff_time

    def payload(self) -> list[Figure]:
        """Return position error about the mission's reference, tilt, speed and clearance; empty: no estimate."""
        flight, record = self._flight, self._flight.last_record
        if record is None or flight.time - record.estimate.time > _ESTIMATE_AGE:
            return []
        x, time = record.estimate.x[:12].tolist(), record.estimate.time
        error = math.dist(x[0:3], flight.reference(np.array([time]))[0][0])
        return [
            Figure(f"error {error:5.2f} m"),
            Figure(f"tilt {math.degrees(max(abs(x[6]), abs(x[7]))):4.1f} deg"),
            Figure(f"speed {math.hypot(*x[3:6]):4.1f} m/s"),
            self._clearance(record),
        ]

    def _clearance(self, record: StepRecord) -> Figure:
        """Return the least distance of the hull from what is on the obstacle map, less its growth.

        The hull is that of a level payload where the estimate has it, with the links of the plan.
        """
        position, acceleration = record.estimate.x[None, 0:3], record.decision.flat.payload[2, :1]
        region = Region(position[0], self._range + self._reach)
        found = self._flight.system.obstacle_map.predict(np.array([record.estimate.time]), region)
        near = separations(self._formation, position, acceleration, PredictedObstacles(found), self._range)
        if not near:
            return Figure(f"no obstacle within {self._range:.0f} m")
        least = min(separation.clearance for separation in near)
        margin = self._flight.mission.system.avoidance.margin
        state = OK if least >= margin else WARNING if least > 0.0 else BAD
        return Figure(f"clearance {least:.2f} m (margin {margin:.2f} m)", state)

    def links(self) -> list[Figure]:
        """Return loss (%), one-way latency (ms) and rate (Hz) of the telemetry of each vehicle."""
        return [link.figure() for link in self._links]


class _PlannedFlight(NamedTuple):
    """Durations (s) of a flight: from the touchdown before it to its climb, and from there to its touchdown."""

    on_ground: float
    in_air: float


def _planned_durations(mission: Mission) -> list[_PlannedFlight]:
    """Return the durations of all flights at the mission's own speed; one of inf: endless, or too long."""
    endless = [_PlannedFlight(0.0, math.inf)]
    if isinstance(mission.reference, Route) and flown_legs(mission.reference, mission.system).end is not End.LANDING:
        return endless
    system, settings = mission.system, mission.system.flight.takeoff_landing
    legs = MissionLegs.of(mission)
    place = np.array([0.0, 0.0, -system.resting_altitude])
    spooling = settings.spool_down_time + settings.settle_time + settings.offboard_delay + settings.spool_up_time
    flights: list[_PlannedFlight] = []
    while not legs.ended and sum(each.in_air for each in flights) < _LONGEST:
        standing = sum(leg.seconds for leg in legs.on_ground() if isinstance(leg, Stand))
        if not legs.takes_off:
            break
        trajectory = MissionTrajectory(mission, place, 0.0, legs.flight()).trajectory
        trajectory.position(_LONGEST)  # a lazy trajectory knows its end once it is evaluated there
        flights.append(_PlannedFlight(spooling + standing, trajectory.end))
        place = np.array([*trajectory.position(_LONGEST)[:2], place[2]])
    return flights if legs.ended else endless


class _LinkStatus:
    """Status of one link, by sequence numbers and TIMESYNC."""

    def __init__(self, flight: Flight, link: VehicleLink) -> None:
        self._flight, self._link = flight, link
        self._counts: deque[tuple[float, int, int]] = deque()
        """Ground time (s), messages received and missing."""
        self._count()

    def _count(self) -> tuple[float, int, int]:
        """Return how long counts were taken (s), and the messages received and missing in this time."""
        now, counts, found = self._flight.ground_time, self._counts, self._link.statistics
        counts.append((now, found.received, found.missing))
        while len(counts) > 2 and now - counts[1][0] >= _LINK_WINDOW:
            counts.popleft()
        since, received, missing = counts[0]
        return now - since, found.received - received, found.missing - missing

    def figure(self) -> Figure:
        """Return what there is to be shown."""
        link, system = self._link, self._flight.mission.system
        limits, name = system.flight.failsafe, f"link {link.system_id}:"
        duration, received, missing = self._count()
        silent = self._flight.ground_time - link.telemetry_received_at
        if math.isinf(silent):
            return Figure(f"{name} no telemetry yet", WARNING)
        if silent > limits.telemetry_timeout:
            return Figure(f"{name} no telemetry for {silent:.1f} s", BAD)
        loss, latency = missing / max(received + missing, 1), link.clock.delay
        rate = received / duration if duration > 0.0 else 0.0
        is_late = latency > system.flight.monitor.latency_periods / system.rates.control
        state = WARNING if is_late or loss > system.mavlink.link.second_copy_loss else OK
        if latency > limits.latency_limit:
            state = BAD
        return Figure(f"{name} loss {100.0 * loss:4.1f} %, {1e3 * latency:3.0f} ms, {rate:3.0f} Hz", state)
