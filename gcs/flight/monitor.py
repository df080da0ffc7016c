"""What the ground notices in flight: looks at links, clocks, measurements and forces, and writes the alarm record."""

from __future__ import annotations

import math
from collections import deque

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from gcs.flight.alarms import Alarm, AlarmBook, Events
from gcs.flight.flight import Flight, StepRecord
from gcs.flight.phase import IN_THE_AIR
from gcs.mavlink.id_check import Identities
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.control.controller import Decision
from idc_controller.estimation.estimate import Estimate
from idc_controller.estimation.health.innovation_monitor import InnovationMonitor
from idc_controller.estimation.measurements import PAYLOAD, Position
from idc_controller.estimation.settings import InnovationMonitorSettings
from idc_controller.perception.obstacle_map import ObstacleMap

Array = NDArray[np.float64]

MISSED = 5
"""So many samples of a vehicle or of the payload in a row that do not come are silence: with a loss of 1 % they all get
lost once in 1e10 times."""
SEVERAL, LATELY = 3, 2.0
"""Losses, or messages twice or out of order, on one link within so long (s). A link that loses one datagram in a
thousand loses three of the 50 of this time once in 5e4 times."""
SETPOINTS_LATELY = 5.0
"""The same of set-points (s): once one is lost copies are sent, and few more are."""
LATE, UNSTEADY = 0.025, 0.0125
"""Time that datagrams take one way, and by how much it varies (s): half and a quarter of a control period."""
CLOCK_STEP, CLOCK_MEMORY = 0.01, 5.0
"""So much (s) may a vehicle's clock go wrong within the memory (s): twenty times what a bad quartz does."""
HARD, SETTLED = 0.1, 2.0
"""A set-point of tilt that changes by more (rad) from one step to the next asks of the attitude loop what its linear
model does not tell. UAVs' attitudes, and what is judged of all sensors together, say nothing of faults until so long
(s) after: avoiding an obstacle that is found late changes set-points by up to 0.8 rad."""
NOISY = 4.0
"""Factor of all sensors' variances; clean flights reach 2."""
FORCE = float(chi2.isf(InnovationMonitorSettings().false_alarm, 3))
"""Of the force on the payload, squared by its own covariance."""


class Watch:
    """Call :meth:`step` once a control step, after the flight's own; times are the team's (s)."""

    def __init__(self, flight: Flight, obstacle_map: ObstacleMap | None, identities: Identities) -> None:
        self._flight, self._team, self._obstacle_map = flight, flight.team, obstacle_map
        self._identities = identities
        self._book = AlarmBook()
        self._silence = MISSED / flight.mission.system.rates.telemetry
        self._heard: dict[str, float] = {}
        self._counts: dict[tuple[str, str, str], int] = {}
        self._events = Events(LATELY)
        self._setpoints = Events(SETPOINTS_LATELY)
        self._offsets: dict[str, deque[tuple[float, float]]] = {_name(link): deque() for link in self._team.links}
        self._innovations = InnovationMonitor(flight.estimator.settings.gate_probability)
        self._tilts: Array | None = None
        self._calm_from = -math.inf
        self._stopped = False

    @property
    def alarms(self) -> list[Alarm]:
        """All so far."""
        return self._book.alarms

    def step(self, time: float, now: float, record: StepRecord | None) -> list[Alarm]:
        """What is new at team ``time``, ground time ``now``; ``record``: of the flight's step, if it made one."""
        known = len(self.alarms)
        airborne = self._flight.phase in IN_THE_AIR
        for link in self._team.links:
            self._count(link, time, now)
        if airborne:
            self._links(time, now)
        if airborne and record is not None and self._flight.payload.is_clear(record.estimate):
            calm = self._is_calm(time, record.decision)
            for innovation in record.estimate.innovations:
                self._innovations.learn(innovation.time, innovation.keys, innovation.normalised, innovation.rejected)
                if innovation.covariance_reset and calm:
                    self._events.add(("team", "surprised"), innovation.time)
            if not calm:
                self._innovations.forget_attitudes()
            self._measurements(time, calm)
            self._model(time, record.estimate, calm)
        if airborne:
            for events in (self._events, self._setpoints):
                for (source, what), count in events.recent(time).items():
                    if count >= SEVERAL:
                        self._book.tell(time, source, what)
        self._obstacles(time)
        flight = self._flight
        if flight.reason and not self._stopped and not math.isnan(flight.takeoff_time):
            self._stopped = True
            if not flight.interrupted:
                self._book.tell(flight.broken_off_time, "team", "stopped", flight.reason)
        return self.alarms[known:]

    def _is_calm(self, time: float, decision: Decision) -> bool:
        """Whether the set-points have not changed hard for a while."""
        tilts = decision.u[: 2 * len(self._team.links)]
        if self._tilts is not None and float(np.abs(tilts - self._tilts).max()) > HARD:
            self._calm_from = time + SETTLED
        self._tilts = tilts
        return time >= self._calm_from

    def _count(self, link: VehicleLink, time: float, now: float) -> None:
        """Also before take-off, so that nothing of that counts."""
        statistics = link.statistics
        statistics.settle(now)
        name = _name(link)
        for source, what, events, count in (
            (name, "messages lost", self._events, statistics.lost),
            (name, "messages overtaken", self._events, statistics.overtaken),
            (name, "messages twice", self._events, statistics.twice),
            (name, "messages damaged", self._events, statistics.damaged),
            (name, "not finite", self._events, statistics.not_finite),
            ("payload", "not finite", self._events, statistics.payload_not_finite),
            (name, "set-points lost", self._setpoints, link.lost_setpoints),
        ):
            # Every vehicle relays the payload's: counted for each.
            key = name, source, what
            if (more := count - self._counts.get(key, 0)) > 0:
                events.add((source, what), time, more)
                self._counts[key] = count
        offsets = self._offsets[name]
        offsets.append((time, link.clock.offset))
        while time - offsets[0][0] > CLOCK_MEMORY:
            offsets.popleft()

    def _links(self, time: float, now: float) -> None:
        tell = self._book.tell
        for link in self._team.links:
            name, clock = _name(link), link.clock
            if (silent := self._silent(name, link.whole_telemetry_heard, now)) > self._silence:
                tell(time, name, "silent", f"no telemetry for {silent:.2f} s")
            if not link.sees:
                tell(time, name, "blind", "its range sensor does not work")
            if clock.delay > LATE:
                tell(time, name, "late", f"{clock.delay * 1e3:.0f} ms one way")
            elif clock.spread > UNSTEADY:
                tell(time, name, "unsteady", f"the way takes {clock.spread * 1e3:.0f} ms more or less")
            else:
                offsets = [offset for _, offset in self._offsets[name]]
                if (moved := max(offsets) - min(offsets)) > CLOCK_STEP:
                    tell(time, name, "clock", f"{moved * 1e3:.0f} ms off in {CLOCK_MEMORY:g} s")
        relayed = max(link.payload_heard for link in self._team.links)
        if (silent := self._silent("payload", relayed, now)) > self._silence:
            tell(time, "payload", "silent", f"not relayed for {silent:.2f} s")

    def _silent(self, name: str, heard: float, now: float) -> float:
        """For how long (s), also if it was over before it could be looked at."""
        before, self._heard[name] = self._heard.get(name, heard), heard
        return max(now - heard, heard - before)

    def _measurements(self, time: float, calm: bool) -> None:
        for teller, whose in self._identities.mixed_up.items():
            self._book.tell(time, self._source(teller), "mixed up", f"tells the data of {self._source(whose)}")
        health = self._flight.estimator.health
        for channel in health.stuck_channels:
            self._book.tell(time, self._source(channel.source), "frozen", channel.name)
        for channel in health.isolation.isolated:
            if calm or channel.kind is Position:
                self._book.tell(time, self._source(channel.source), "distrusted", channel.name)
        for group, (poses, _) in health.isolated_groups.items():
            names = ("positions", "velocities") if group.kind is Position else ("attitudes", "rates")
            who, of = ("payload", "the payload") if group.of_payload else ("team", "all vehicles")
            self._book.tell(time, who, "contradicts", f"{names[0 if poses else 1]} of {of} are left out")
        for (source, kind), findings in self._innovations.findings(time).items():
            for finding in findings:
                self._book.tell(time, self._source(source), finding, kind.__name__.lower())

    def _model(self, time: float, estimate: Estimate, calm: bool) -> None:
        adaptation, force, n = self._flight.estimator.health.adaptation, estimate.force, len(estimate.x)
        if calm and adaptation.measurement_scale > NOISY:
            self._book.tell(time, "team", "noisy", "all sensors")
        if calm and adaptation.is_at_limit:
            self._book.tell(time, "payload", "restless", "forces change quickly")
        covariance = estimate.covariance[n : n + 3, n : n + 3]
        if float(force @ np.linalg.solve(covariance, force)) > FORCE:
            self._book.tell(time, "payload", "force", " ".join(f"{f:.1f}" for f in force) + " N north east down")

    def _obstacles(self, time: float) -> None:
        if self._obstacle_map is None:
            return
        for name in self._obstacle_map.vanished:
            self._book.tell(time, name, "unseen", "although a vehicle is near")
        self._obstacle_map.vanished.clear()
        for uav, offset in self._obstacle_map.astray.items():
            off = float(np.linalg.norm(offset))
            self._book.tell(time, self._source(uav), "off the map", f"what it sees of obstacles, by {off:.2f} m")

    def _source(self, source: int) -> str:
        return "payload" if source == PAYLOAD else _name(self._team.links[source])


def _name(link: VehicleLink) -> str:
    return f"vehicle {link.system_id}"
