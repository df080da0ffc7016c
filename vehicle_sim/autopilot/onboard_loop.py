"""The onboard loop of a team: its arithmetic in one call for all vehicles, its decisions vehicle by vehicle."""

from collections.abc import Sequence
from typing import Protocol

from idc_controller.arrays import Array
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import control_attitudes, detect_landings, find_ordinary
from vehicle_sim.world.sensors import Measurement


class Decisions(Protocol):
    """What a vehicle decides on its own; see :class:`~vehicle_sim.autopilot.autopilot.Autopilot`."""

    def sense(self, sample: Measurement | None, ordinary: bool, now: float) -> None:
        """Take what the sensors delivered; ``ordinary`` samples need no closer look."""

    @property
    def flies_setpoints(self) -> bool:
        """Return True if it flies set-points of the ground."""

    def decide(self, now: float) -> bool:
        """Check the failsafes, and say what the rotors are to do; return True if a HEARTBEAT changes."""


def step_together(
    autopilots: Sequence[Decisions],
    arrays: OnboardArrays,
    samples: Sequence[Measurement | None],
    rows: Array,
    now: float,
) -> list[int]:
    """Take one step of the onboard loops: rotor-speed commands in ``arrays``; return whose HEARTBEAT changes.

    ``samples``: what the vehicles' sensors delivered, None where no sample came this time; ``rows`` (N, 13): the same
    as rows of states, of missing ones anything. No vehicle learns anything of another.
    """
    if None in samples:
        missing = [sample is None for sample in samples]
        rows[missing] = arrays.last_samples[missing]
    find_ordinary(rows, arrays.last_samples, arrays.estimates, arrays.ordinary)
    for autopilot, sample, ordinary in zip(autopilots, samples, arrays.ordinary.tolist(), strict=True):
        autopilot.sense(sample, ordinary, now)
    arrays.learns[:] = [autopilot.flies_setpoints for autopilot in autopilots]
    detect_landings(arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, now, arrays.landings)
    changed = [i for i, autopilot in enumerate(autopilots) if autopilot.decide(now)]
    control_attitudes(arrays.airframes, arrays.estimates, arrays.targets, arrays.accelerations, arrays.speeds)
    return changed
