"""What lies between the vehicles and everything else: their sensors on one side, the wire on the other."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from gcs.mavlink.address import Address
from idc_controller.rotations_float import Vector
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, Told

if TYPE_CHECKING:
    from vehicle_sim.world.world import World

Datagram = tuple[bytes, Address]
"""Bytes, and the address on the other side."""

Forces = tuple[Vector, Sequence[Vector]]
"""On the payload, and on each UAV: at the centres of mass, north-east-down (N)."""


class Passage:
    """Lets everything through, at once and unchanged. Whatever disturbs a flight overrides a method of this class.

    Vehicles are numbered by their system id, from 1. Times in s.
    """

    def took_off(self, time: float) -> None:
        """The first vehicle has lifted off at ``time``."""

    def disturb(self, world: World, now: float) -> Forces | None:
        """Before every physics step: what presses on payload and UAVs besides gravity and thrust; None: nothing."""
        return None

    def clock(self, vehicle: int, now: float) -> float:
        """What a vehicle's own clock shows: the base of its stamps."""
        return now

    def own_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """What a vehicle's autopilot gets of its own measurement; None: nothing."""
        return sample

    def told(self, vehicle: int, sample: Measurement | None) -> Told:
        """What a vehicle tells of its own measurement, which is what its autopilot flies by."""
        return Told(sample, sample)

    def payload_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """What a vehicle gets to relay of the payload unit's measurement; None: nothing."""
        return sample

    def range_sample(self, vehicle: int, sample: RangeSample) -> RangeSample | None:
        """What a vehicle gets to pass on of its range sensor's scan; None: nothing."""
        return sample

    def to_vehicle(self, vehicle: int, arriving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Of the datagrams that come from outside, now or before, those that the vehicle gets now."""
        return arriving

    def from_vehicle(self, vehicle: int, leaving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Of the datagrams that the vehicle sends, now or before, those that leave now."""
        return leaving

    def next_timer(self) -> float | None:
        """When something that was held back is due; None: never as things are."""
        return None
