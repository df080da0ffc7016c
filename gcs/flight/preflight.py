"""Before take-off: all data that a flight needs, and where payload and vehicles are on the ground."""

import math

import numpy as np

from gcs.config.flight_settings import DEFAULTS, FlightSettings
from gcs.flight.autopilot_requirements import PARAMETERS, missing
from gcs.flight.team import Team
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Attitude, Measurement, SensorKey
from idc_controller.rotations import rotation_from_quaternion

_QUEUE_WAIT = 0.02
"""s for which datagrams usually wait, at least, on a link that is measured."""
_MEASURED = 15
"""Datagrams by which its rate is measured."""
_STAMP = 1e-3
"""Resolution of the stamps of telemetry (s)."""
_ATTITUDES = 5
"""Attitudes of each source that are averaged: of white noise a tenth of the limit is never exceeded."""
_RATE_ERROR = 0.2
"""Of a clock, beyond what jitter makes of the settle time: a simulation that runs at another speed."""


class Preflight:
    """Connection to all vehicles, then the mean of their positions on the pad (NED, m)."""

    def __init__(self, team: Team, settings: FlightSettings = DEFAULTS) -> None:
        self._team, self._settings = team, settings
        self.connect_start = math.nan
        """Time of the first attempt to connect (s, ground)."""
        self.check_start = math.nan
        """Time at which all had connected (s, team)."""
        self.uptime = 0.0
        """Whole seconds for which the first vehicle had been up when the ground began: team time counts them."""
        self.missing = ""
        """Vehicles that have not connected, else all that those which have lack of what a flight needs; empty: none."""
        self.landed = False
        """Whether the payload stands where it has landed, no more on the pad."""
        self._stamps: list[tuple[float, float] | None] = []
        """Of each vehicle when all had connected: the newest stamp, and its arrival (s)."""
        self._newest: dict[int, float] = {}
        """Time (s, team) of the newest position of each source."""
        self._intervals: dict[int, float] = {}
        """Shortest interval of the positions of each source (s): what is lost makes others longer."""
        self.latest: dict[SensorKey, Measurement] = {}
        """The newest measurements of each source."""
        self._positions: dict[int, list[Array]] = {source: [] for source in (PAYLOAD, *range(len(team.links)))}
        self._axes: dict[int, list[Array]] = {source: [] for source in self._positions}
        """Level parts (2,) of the newest attitudes' downward axes of each source."""

    def attitude_errors(self) -> list[float]:
        """Return the angle on the pad of each vehicle's axis to the payload unit's (N,) (rad); 0: not known yet."""
        payload, *vehicles = (self._axes[source] for source in (PAYLOAD, *range(len(self._team.links))))
        if len(payload) < _ATTITUDES:
            return [0.0] * len(vehicles)
        level = np.mean(payload, axis=0)
        return [
            float(np.linalg.norm(np.mean(axes, axis=0) - level)) if len(axes) == _ATTITUDES else 0.0
            for axes in vehicles
        ]

    def restart(self, *, landed: bool) -> None:
        """Begin anew: on the pad, or where the payload has ``landed``."""
        self.landed = landed
        self.connect_start = self.check_start = math.nan
        self._newest.clear()
        self._intervals.clear()
        for samples in (*self._positions.values(), *self._axes.values()):
            samples.clear()

    def connect(self, now: float) -> bool:
        """Request what is missing at ``now`` (s, ground); return whether all vehicles have sent all."""
        # Team time jumps with the first telemetry: only the ground's clock measures the timeout.
        if math.isnan(self.connect_start):
            self.connect_start = now
        timeout = self._settings.failsafe.telemetry_timeout
        silent = []
        incomplete: dict[str, list[int]] = {}
        for link in self._team.links:
            link.requests.want_parameters(PARAMETERS)
            if now - link.received_at > timeout:
                silent.append(f"vehicle {link.system_id} {_silence(link)}")
            elif lacking := missing(link, now - timeout, at_connect=True):
                incomplete.setdefault(", ".join(lacking), []).append(link.system_id)
                if now - link.payload_received_at > timeout:
                    link.requests.want_payload_unit()
        if silent:
            team = len(self._team.links)
            self.missing = f"{team - len(silent)} of {team} vehicles connected: {'; '.join(silent)}"
        else:
            self.missing = "; ".join(f"{_vehicles(ids)} not sent {what}" for what, ids in incomplete.items())
        if not self.missing:
            for link in self._team.links:
                link.requests.want_log()
            self._stamps = [link.clock.newest for link in self._team.links]
        return not self.missing

    def add(self, measurement: Measurement) -> None:
        """Take telemetry of a vehicle or of the payload unit on the ground."""
        if measurement.has_pose:
            self.latest[measurement.source, type(measurement)] = measurement
        if isinstance(measurement, Attitude):
            if measurement.has_pose:
                axes = self._axes[measurement.source]
                axes.append(rotation_from_quaternion(measurement.pose)[:2, 2])
                del axes[:-_ATTITUDES]
            return
        if measurement.has_pose:
            source, time = measurement.source, measurement.time
            interval = time - self._newest.get(source, math.nan)
            if not interval <= 0.0:
                self._newest[source] = time
                self._intervals[source] = min(interval, self._intervals.get(source, math.inf))
            samples = self._positions[source]
            samples.append(measurement.pose)
            del samples[: -self._settings.takeoff_landing.position_samples]

    def is_settled(self, time: float) -> bool:
        """Return whether telemetry has been averaged, and links measured, for long enough at team ``time`` (s)."""
        checked = time - self.check_start
        if not checked >= self._settings.takeoff_landing.settle_time:
            return False
        if self.wrong_clock is not None and checked <= self._settings.failsafe.connect_timeout:
            return False  # one that was held up for a moment catches up
        few = any(self.queues(link) and len(link.clock.queue) < _MEASURED for link in self._team.links)
        return not few or checked > self._settings.failsafe.connect_timeout

    @property
    def wrong_clock(self) -> tuple[VehicleLink, float] | None:
        """The first vehicle whose clock does not go as the ground's, with its seconds a second; None: all do.

        Stamps that wait in a queue, longer and longer, say nothing of a clock.
        """
        for link, first in zip(self._team.links, self._stamps, strict=False):
            newest = link.clock.newest
            if first is None or newest is None or newest[1] <= first[1] or self.queues(link):
                continue
            rate = (newest[0] - first[0]) / (newest[1] - first[1])
            if abs(rate - 1.0) > _RATE_ERROR:
                return link, rate
        return None

    def queues(self, link: VehicleLink) -> bool:
        """Return whether datagrams of a vehicle wait for each other, as on a link that hardly carries them."""
        # A clock that drifts delays stamps, too, but no round trip.
        return min(link.clock.queue.wait, link.clock.round_trip_excess) > _QUEUE_WAIT

    def slow_source(self, interval: float) -> tuple[int, float] | None:
        """Return the first source whose positions come less often than once in ``interval`` (s), and its own interval.

        The payload unit counts by the rate at which all vehicles together relay it.
        """
        for source, own in self._intervals.items():
            if math.isfinite(own) and own > interval + _STAMP:
                return source, own
        return None

    @property
    def has_positions(self) -> bool:
        """True if every vehicle and the payload unit have sent a position."""
        return all(self._positions.values())

    @property
    def positions_until(self) -> float:
        """Time (s, team) until which all have sent positions, the payload unit, too; -inf: one has sent none."""
        return min(self._newest.get(source, -math.inf) for source in self._positions)

    def is_current(self, time: float) -> bool:
        """Return whether no position is older at team ``time`` (s) than telemetry may be in flight."""
        return self.has_positions and time - self.positions_until <= self._settings.failsafe.telemetry_timeout

    @property
    def payload(self) -> Array:
        """Position of the payload (3,)."""
        return np.asarray(np.mean(self._positions[PAYLOAD], axis=0))

    @property
    def vehicles(self) -> Array:
        """Positions of the vehicles (N, 3)."""
        return np.array([np.mean(samples, axis=0) for source, samples in self._positions.items() if source != PAYLOAD])


def _silence(link: VehicleLink) -> str:
    """Return how a vehicle is missing from which nothing has come."""
    if link.address is None:
        return "has not called in"
    other = "" if link.conflict.other_system_id is None else f": vehicle {link.conflict.other_system_id} does"
    return f"does not answer at {link.address[0]}:{link.address[1]}{other}"


def _vehicles(system_ids: list[int]) -> str:
    """Return the vehicles of a sentence, with its verb."""
    names = ", ".join(map(str, system_ids))
    return f"vehicle {names} has" if len(system_ids) == 1 else f"vehicles {names} have"
