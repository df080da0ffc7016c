"""Settings of trajectories: how a team without set-points brakes."""

from dataclasses import dataclass

from idc_controller.settings import setting


@dataclass(frozen=True)
class BrakingSettings:
    """Duration of a stop: the least, or as long as the deceleration demands."""

    time: float = setting(4.0, "s", "least time in which a team without set-points comes to rest", gt=0.0)
    deceleration: float = setting(2.0, "m/s2", "largest deceleration of that stop; a faster team takes longer", gt=0.0)
