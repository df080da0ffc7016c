"""Faults on purpose: a passage that disturbs samples, datagrams and the world as a mission says."""

from vehicle_sim.faults.fault_injector import FaultPassage
from vehicle_sim.faults.record import record_faults

__all__ = ["FaultPassage", "record_faults"]
