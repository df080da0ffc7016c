"""Where faults act: between the vehicles and their sensors, between the vehicles and the wire, and on the world."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gcs.mavlink.address import Address
from idc_controller.rotations_float import Vector
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState

if TYPE_CHECKING:
    from vehicle_sim.world.world import World

Datagram = tuple[bytes, Address]
"""Bytes, and the address on the other side."""

Forces = tuple[Vector, Sequence[Vector]]
"""On the payload, and on each UAV: at the centres of mass, north-east-down (N)."""


class FaultInterface:
    """No fault: everything passes at once and unchanged. Whatever disturbs a flight overrides methods of this class.

    Vehicles are numbered by their system id, from 1. Times in s.
    """

    def took_off(self, time: float) -> None:
        """Take note that the first vehicle has lifted off at ``time``."""

    def disturb(self, world: World, now: float) -> Forces | None:
        """Return the forces on payload and UAVs besides gravity and thrust in a physics step; None: no force."""
        return None

    def clock(self, vehicle: int, now: float) -> float:
        """Return the time of a vehicle's own clock: the base of its stamps."""
        return now

    def own_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what a vehicle's autopilot gets of its own measurement; None: nothing."""
        return sample

    def reported_sample(self, vehicle: int, sample: Measurement | None) -> ReportedState:
        """Return what a vehicle's telemetry reports of the measurement that its autopilot flies by."""
        return ReportedState(sample, sample)

    def payload_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what a vehicle gets to relay of the payload unit's measurement; None: nothing."""
        return sample

    def range_sample(self, vehicle: int, sample: RangeSample) -> RangeSample | None:
        """Return what a vehicle gets to report of its range sensor's scan; None: nothing."""
        return sample

    def to_vehicle(self, vehicle: int, arriving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Return the datagrams that reach the vehicle now, of those ``arriving`` and of earlier ones."""
        return arriving

    def from_vehicle(self, vehicle: int, leaving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Return the datagrams that leave the vehicle's link now, of those ``leaving`` and of earlier ones."""
        return leaving

    def next_timer(self) -> float | None:
        """Return when a delayed datagram is due; None: none is delayed."""
        return None
