"""Before take-off: all data that a flight needs, and where payload and vehicles are on the ground."""

import math

import numpy as np

from gcs.config.flight_settings import DEFAULTS, FlightSettings
from gcs.flight.team import Team
from gcs.mavlink import px4
from gcs.mavlink.vehicle_link import VehicleLink
from idc_controller.arrays import Array
from idc_controller.estimation.measurements import PAYLOAD, Measurement, Position

NEEDED_PARAMETERS = (
    px4.PARAM_THRUST_MAX,
    px4.PARAM_ATTITUDE_KP,
    px4.PARAM_ATTITUDE_KD,
    px4.PARAM_MOTOR_LAG,
    px4.PARAM_ONBOARD_RATE,
    px4.PARAM_SETPOINT_LOSS,
    px4.PARAM_LAND_DELAY,
)
_QUEUE_WAIT = 0.02
"""s for which datagrams usually wait, at least, on a link that is measured."""
_MEASURED = 15
"""Datagrams by which its rate is measured."""


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
        """Vehicles that have not connected, else the data that the first incomplete one lacks; empty: none."""
        self._positions: dict[int, list[Array]] = {source: [] for source in (PAYLOAD, *range(len(team.links)))}

    def connect(self, now: float) -> bool:
        """Request what is missing at ``now`` (s, ground); return whether all vehicles have sent all."""
        # Team time jumps with the first telemetry: only the ground's clock measures the timeout.
        if math.isnan(self.connect_start):
            self.connect_start = now
        timeout = self._settings.failsafe.telemetry_timeout
        silent, incomplete = [], []
        for link in self._team.links:
            link.requests.want_parameters(NEEDED_PARAMETERS)
            if now - link.received_at > timeout:
                silent.append(f"vehicle {link.system_id} {_silence(link)}")
            elif missing := _missing(link, now, timeout):
                incomplete.append(f"vehicle {link.system_id} {missing}")
                if now - link.payload_received_at > timeout:
                    link.requests.want_payload_unit()
        if silent:
            team = len(self._team.links)
            self.missing = f"{team - len(silent)} of {team} vehicles connected: {'; '.join(silent)}"
        else:
            self.missing = incomplete[0] if incomplete else ""
        if not self.missing:
            for link in self._team.links:
                link.requests.want_log()
        return not self.missing

    def add(self, measurement: Measurement) -> None:
        """Take telemetry of a vehicle or of the payload unit on the ground."""
        if isinstance(measurement, Position) and measurement.has_pose:
            samples = self._positions[measurement.source]
            samples.append(measurement.pose)
            del samples[: -self._settings.takeoff_landing.position_samples]

    def is_settled(self, time: float) -> bool:
        """Return whether telemetry has been averaged, and links measured, for long enough at team ``time`` (s)."""
        checked = time - self.check_start
        if not checked >= self._settings.takeoff_landing.settle_time:
            return False
        few = any(self.queues(link) and len(link.clock.queue) < _MEASURED for link in self._team.links)
        return not few or checked > self._settings.failsafe.connect_timeout

    def queues(self, link: VehicleLink) -> bool:
        """Return whether datagrams of a vehicle wait for each other, as on a link that hardly carries them."""
        # A clock that drifts delays stamps, too, but no round trip.
        return min(link.clock.queue.wait, link.clock.round_trip_excess) > _QUEUE_WAIT

    @property
    def has_positions(self) -> bool:
        """True if every vehicle and the payload unit have sent a position."""
        return all(self._positions.values())

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


def _missing(link: VehicleLink, now: float, timeout: float) -> str:
    """Return what a flight needs and a vehicle has not sent; empty: nothing. ``timeout`` (s) for telemetry."""
    if now - link.complete_telemetry_received_at > timeout:
        return "sends no attitude and position"
    if now - link.payload_received_at > timeout:
        return "relays no payload navigation data"
    if absent := [name for name in NEEDED_PARAMETERS if name not in link.status.parameters]:
        return "does not send " + ", ".join(absent)
    return "has not reported whether it is ready" if link.status.prearm_ok is None else ""
