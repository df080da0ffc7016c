"""Where faults may act on a swarm: its world, its samples and its datagrams; without faults, all pass as they are."""

from collections.abc import Callable, Sequence

from gcs.mavlink.address import Address
from idc_controller.rotations_float import Vector
from vehicle_sim.world.range_sensor import RangeSample
from vehicle_sim.world.sensors import Measurement, ReportedState
from vehicle_sim.world.world import World

Datagram = tuple[bytes, Address]
"""Bytes, and the address on the other side."""
Forces = tuple[Vector, Sequence[Vector]]
"""Forces on the payload and on each UAV, at the centres of mass, north-east-down (N)."""


class Disturbances:
    """What a swarm passes its samples, datagrams and world through. This base class leaves all of them as they are.

    Vehicles are numbered by their system id, from 1; times in s. ``any_of_world``: a fault acts on the world.
    """

    any_of_world = False

    def took_off(self, time: float) -> None:
        """Start the schedules of all faults: the first vehicle has lifted off."""

    # The world

    def disturb(self, world: World, now: float) -> Forces | None:
        """Set the load, and return the forces of the wind on payload and UAVs; None: no force."""
        return None

    # Clocks and samples

    def clock_of(self, vehicle: int) -> Callable[[float], float]:
        """Return what the vehicle's clock shows at a time (s): without a fault of clocks the time itself."""
        return float

    def disturbs_samples(self, vehicle: int) -> bool:
        """Return True if a fault acts on samples of the vehicle or on those it relays, now or at another time."""
        return False

    def own_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what the autopilot gets of the vehicle's own measurement; None: nothing."""
        return sample

    def reported_sample(self, vehicle: int, sample: Measurement | None) -> ReportedState:
        """Return what the telemetry reports of the measurement that the autopilot flies by."""
        return ReportedState(sample, sample)

    def payload_sample(self, vehicle: int, sample: Measurement) -> Measurement | None:
        """Return what the vehicle gets to relay of the payload unit's measurement; None: nothing."""
        return sample

    def range_sample(self, vehicle: int, sample: RangeSample) -> RangeSample | None:
        """Return what the vehicle gets to report of a scan; None: nothing."""
        return sample

    # Datagrams

    def to_vehicle(self, vehicle: int, arriving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Return the datagrams that reach the vehicle now, of those ``arriving`` and of earlier ones."""
        return arriving

    def from_vehicle(self, vehicle: int, leaving: Sequence[Datagram], now: float) -> Sequence[Datagram]:
        """Return the datagrams that go on to the ground now, of those ``leaving`` and of earlier ones."""
        return leaving

    def next_timer(self) -> float | None:
        """Return when the next delayed datagram is due."""
        return None
