"""The onboard loop of a team: its arithmetic in one call for all vehicles, its decisions vehicle by vehicle."""

from collections.abc import Collection, Sequence
from typing import Protocol

from idc_controller.arrays import Array
from vehicle_sim.autopilot.onboard_arrays import OnboardArrays
from vehicle_sim.autopilot.onboard_kernels import (
    COMMANDED,
    SAMPLED,
    control_attitudes,
    detect_landings,
    step_while_idle,
)
from vehicle_sim.world.sensors import Measurement


class Decisions(Protocol):
    """What a vehicle decides on its own; see :class:`~vehicle_sim.autopilot.autopilot.Autopilot`."""

    def sense(self, sample: Measurement, now: float) -> None:
        """Take a sample that is not fresh."""

    def decide(self, now: float) -> bool:
        """Check the failsafes, and say what the rotors are to do; return True if a HEARTBEAT changes.

        It also says in ``arrays.idle_until`` how long that stays so.
        """


def step_together(
    autopilots: Sequence[Decisions],
    arrays: OnboardArrays,
    samples: Array,
    times: Array,
    now: float,
    missing: Collection[int] = (),
) -> list[int]:
    """Take one step of the onboard loops: rotor-speed commands in ``arrays``; return whose HEARTBEAT changes.

    ``samples`` (N, 13): what the vehicles' sensors delivered, rows of states, measured at ``times`` (N,) (s);
    ``missing``: vehicles (from 0) to which no sample came this time. No vehicle learns anything of another. Only
    vehicles that are not idle decide: the others would decide what they did.
    """
    for i in missing:
        samples[i] = arrays.last_samples[i]
    stage = step_while_idle(
        samples, times, now, arrays.last_samples, arrays.estimates, arrays.stamps, arrays.fresh,
        arrays.detectors, arrays.targets, arrays.learns, arrays.landings, arrays.idle_until,
        arrays.airframes, arrays.accelerations, arrays.speeds, arrays.rate_checks,
    )  # fmt: skip
    if stage == COMMANDED:
        return []
    if stage == SAMPLED:
        for i, fresh in enumerate(arrays.fresh.tolist()):
            if not fresh and i not in missing:
                autopilots[i].sense(Measurement.of_row(float(times[i]), samples[i].tolist()), now)
        detect_landings(
            arrays.detectors, arrays.estimates, arrays.targets, arrays.learns, now, arrays.landings, arrays.idle_until
        )
    changed = [
        i for i, idle_until in enumerate(arrays.idle_until.tolist()) if idle_until <= now and autopilots[i].decide(now)
    ]
    control_attitudes(arrays.airframes, arrays.estimates, arrays.targets, arrays.accelerations, arrays.speeds)
    return changed
