"""Settings of the safety filter: weights of its planner, limits of its plans, margins and barrier."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from idc_controller.arrays import Array
from idc_controller.errors import ParameterError
from idc_controller.settings import SettingsTable, Share, derived, setting
from idc_controller.trajectory.integrator_chain import Chain
from idc_controller.trajectory.settings import AvoidanceSettings, Limits

Triple = tuple[float, float, float]


@dataclass(frozen=True, eq=False, repr=False)
class PlannerSettings(SettingsTable):
    """The safety QP: weights of the deviation per axis (x, y, z), limits of the plan, and the barrier."""

    stage: float = 0.1  # s; from stage to stage of a plan
    # stages from knot to knot of the snap; their sum is the horizon
    blocks: tuple[int, ...] = (1, 1, 1, 1, 2, 2, 2, 3, 3, 4, 6, 6)
    position: Triple = setting((0.7, 0.7, 1.0), "", "weight of the deviation's position, x, y, z", ge=0.0)
    velocity: Triple = setting((0.6, 0.6, 0.05), "", "weight of the deviation's velocity, x, y, z", ge=0.0)
    acceleration: float = setting(0.005, "", "weight of the deviation's acceleration", ge=0.0)
    jerk: float = 0.002  # weight of the deviation's jerk
    snap: Triple = (0.001, 0.001, 0.0002)  # weight of the deviation's snap, x, y, z
    crackle: float = 0.0002  # weight of the change of snap from stage to stage: the UAVs' tilt rates follow it
    limits: Limits = derived(Limits())
    """Limits of the motion between waypoints, from which the plan's follow: table ``motion``."""
    acceleration_share: Triple = (2.0, 2.0, 1.8)  # largest acceleration of a plan over that between waypoints, x, y, z
    snap_share: Triple = (1.0, 1.0, 5.0 / 3.0)  # largest snap of a plan over that between waypoints, x, y, z
    ground_clearance: float = 0.05  # m; least height of the payload's underside in a plan
    barrier_rates: tuple[float, ...] = derived(AvoidanceSettings.barrier_rates)
    """Rates of the exponential barrier (1/s), one for each degree: ``avoidance.barrier_rates``."""
    margin: float = derived(AvoidanceSettings.margin)
    """Clearance to keep between hull and obstacles (m): ``avoidance.margin``."""
    tracking: float = setting(0.10, "m", "bound on the payload's deviation from the plan, added to the margin", ge=0.0)
    uav_tracking: float = setting(0.02, "m", "what the rotor discs may deviate beyond that", ge=0.0)
    slack_linear: float = 1000.0  # linear cost of a barrier's slack
    slack_quadratic: float = 100.0  # quadratic cost of a barrier's slack
    # s; with which one slack of an obstacle fades over the horizon and the other sets in: clearance that has to be
    # given up now is won back, and what cannot be kept later excuses nothing now
    slack_time_constant: float = 0.8
    # stages from one at which a plan's limits are kept to the next: between them it cannot change much
    limit_interval: int = 3
    acceleration_spare: float = 0.1  # m/s2; beyond the reference's own acceleration, which a plan may always have
    snap_spare: float = 1.0  # m/s4; beyond the reference's own snap, which a plan may always have
    pop_limit: Triple = setting(
        (60.0, 60.0, 300.0), "m/s6", "largest pop of a plan, the change of its crackle over time, x, y, z", gt=0.0
    )
    pop_spare: float = 5.0  # m/s6; beyond the reference's own pop, which a plan may always have
    limit_slack_linear: float = 3000.0  # linear cost of exceeding the plan's limits: beyond them it cannot be tracked
    limit_slack_quadratic: float = 1000.0  # quadratic cost of exceeding the plan's limits

    @cached_property
    def chain(self) -> Chain:
        """The stages of a plan and the knots of its snap."""
        return Chain(self.stage, self.blocks)

    @property
    def limited_stages(self) -> NDArray[np.int_]:
        """Stages at which the limits of acceleration and height are kept."""
        return np.arange(self.limit_interval, self.chain.stages + 1, self.limit_interval)

    @property
    def acceleration_limit(self) -> Array:
        """Largest acceleration of a plan, x, y, z (m/s2)."""
        return np.array(self.acceleration_share) * self.limits.acceleration

    @property
    def snap_limit(self) -> Array:
        """Largest snap of a plan, x, y, z (m/s4)."""
        return np.array(self.snap_share) * self.limits.snap

    def __post_init__(self) -> None:
        if any(not rate > 0.0 for rate in self.barrier_rates):
            raise ParameterError(f"barrier rates {self.barrier_rates} must be real and positive")
        if self.limit_interval > sum(self.blocks):
            raise ParameterError(
                f"limit_interval {self.limit_interval} is longer than the horizon, {sum(self.blocks)} stages (the sum "
                f"of blocks): the plan's limits would be kept nowhere"
            )


@dataclass(frozen=True, eq=False, repr=False)
class FilterSettings(SettingsTable):
    """Obstacles that take part in a plan, and the succession of plans."""

    watch: float = 2.5  # m; obstacles that come closer to the hull than this take part in the QP
    memory: float = 2.5  # s; how long plans of the past are kept: late measurements refer to them
    recovery: float = 1.5  # s; time constant with which the tracker brings the payload back onto the plan
    excess_max: float = 1.0  # m; largest distance off the plan, beyond the tracking bound, by which obstacles are grown
    # m; distances aside of the nearest stop, on each axis, of those tried without a QP solution
    stops_aside: tuple[float, ...] = (1.0, 2.0)
    switching_share: Share = 0.9  # share of the present plan's cost below which another side of an obstacle is chosen
