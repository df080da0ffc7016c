"""Fault injection: disturbs samples, datagrams and the world as a mission's faults say."""

from vehicle_sim.faults.fault_injector import FaultInjector
from vehicle_sim.faults.record import record_faults

__all__ = ["FaultInjector", "record_faults"]
