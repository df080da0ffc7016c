"""Settings of the tracking controllers: the MPC's horizon, limits and weights, and how the load is learnt."""

from dataclasses import dataclass, field, replace

import numpy as np

from idc_controller.estimation.settings import WindSettings
from idc_controller.settings import SettingsTable, Share, derived, setting

Triple = tuple[float, float, float]

CONTROL_RATE = 20
"""Control steps a second of the default system (Hz): ``rates.control``."""


@dataclass(frozen=True, eq=False, repr=False)
class MpcWeights(SettingsTable):
    """Diagonal of the MPC's cost, a unit of squared error each; lists are x, y, z or roll, pitch, yaw."""

    position: Triple = setting((60.0, 60.0, 200.0), "1/m2", "weight of the payload's position", ge=0.0)
    velocity: Triple = setting((20.0, 20.0, 50.0), "s2/m2", "weight of the payload's velocity", ge=0.0)
    attitude: Triple = setting((300.0, 300.0, 800.0), "1/rad2", "weight of the payload's attitude", ge=0.0)
    rates: Triple = setting((40.0, 40.0, 120.0), "s2/rad2", "weight of the payload's body rates", ge=0.0)
    link_tilt: float = setting(100.0, "1/rad2", "weight of each link's tilt", ge=0.0)
    link_rate: float = setting(30.0, "s2/rad2", "weight of each link's rate", ge=0.0)
    differential_link_tilt: float = setting(
        200.0, "1/rad2", "weight of each link's tilt less the mean of all: keeps the UAVs apart", ge=0.0
    )
    differential_link_rate: float = setting(50.0, "s2/rad2", "weight of each link's rate less the mean of all", ge=0.0)
    uav_tilt: float = setting(1.0, "1/rad2", "weight of a UAV's tilt", ge=0.0)
    uav_tilt_rate: float = setting(0.02, "s2/rad2", "weight of a UAV's tilt rate", ge=0.0)
    thrust: float = setting(0.002, "1/N2", "weight of a UAV's thrust", ge=0.0)
    # The least weights of set-points with which the loop at hover bears a delay of a control period that it does not
    # know of (a set-point that is lost), also with a third of the payload (control/delay_margin.py). The margin
    # does not depend on the vertical weights of position and velocity: they keep the touch-down close to its plan.
    tilt_setpoint: float = setting(60.0, "1/rad2", "weight of a tilt set-point", gt=0.0)
    thrust_setpoint: float = setting(0.12, "1/N2", "weight of a thrust set-point", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class MpcTuning(SettingsTable):
    """Horizon, tilt limits and weights of the MPC: table ``controller``."""

    horizon: int = setting(20, "", "control steps of the prediction", ge=2, le=200)
    payload_tilt_limit_deg: float = setting(5.0, "deg", "soft limit of the payload's tilt", gt=0.0, lt=90.0)
    uav_tilt_limit_deg: float = setting(35.0, "deg", "soft limit of a UAV's tilt", gt=0.0, lt=90.0)
    weights: MpcWeights = field(default_factory=MpcWeights)

    @property
    def payload_tilt_limit(self) -> float:
        """Largest roll, pitch and yaw of the payload (rad, eq:consOsc)."""
        return float(np.radians(self.payload_tilt_limit_deg))

    @property
    def uav_tilt_limit(self) -> float:
        """Largest tilt set-point (rad)."""
        return float(np.radians(self.uav_tilt_limit_deg))


@dataclass(frozen=True, eq=False, repr=False)
class MpcSettings(SettingsTable):
    """Limits of the MPC and the cost of exceeding them."""

    period: float = derived(1.0 / CONTROL_RATE)
    """Control period (s): of ``rates.control``."""
    tuning: MpcTuning = derived(MpcTuning())
    """Table ``controller``."""
    # control steps between the stages of the prediction at which states are constrained, the first on
    constraint_interval: int = 3
    # least upward force in a UAV's set-points, over its own weight: with less the link pushes, and the UAV falls over
    least_lift: Share = 1.0
    thrust_share_max: Share = 0.95  # largest thrust set-point, as a share of the largest thrust
    separation_share: Share = 0.425  # part of the gap between neighbouring rotor discs in hover that has to stay open
    neighbour_share: float = 1.3  # pairs of UAVs up to so many times the least distance apart in hover are neighbours
    slack_linear: float = 1e3  # linear cost of exceeding a limit of the state
    slack_quadratic: float = 1e4  # quadratic cost of exceeding a limit of the state

    # s; set-points that act so long after the newest measurement get the lower bandwidth: two control periods, which a
    # link of 25 ms one way takes, the latency of the alarm link_latency
    late_age: float = 0.1
    late_memory: float = 1.0  # s; for which it is kept
    # by what the weights of set-points are multiplied then: with it the loop bears a delay of a control period that it
    # does not know of, up to a latency of 0.1 s one way (control/delay_margin.py)
    late_setpoint_factor: float = 10.0

    @property
    def late(self) -> "MpcSettings":
        """Settings of the lower bandwidth."""
        weights, factor = self.tuning.weights, self.late_setpoint_factor
        slower = replace(
            weights,
            tilt_setpoint=factor * weights.tilt_setpoint,
            thrust_setpoint=factor * weights.thrust_setpoint,
        )
        return replace(self, tuning=replace(self.tuning, weights=slower))

    @property
    def constraint_stages(self) -> list[int]:
        """Stages of the prediction at which states are constrained."""
        return list(range(1, self.tuning.horizon + 1, self.constraint_interval))


@dataclass(frozen=True, eq=False, repr=False)
class GroundControlSettings(SettingsTable):
    """Regulator that keeps the UAVs upright over a payload on the ground."""

    design_share: float = 0.6  # thrust for which the gain is designed, over hover thrust: with it links come upright
    # weights of link tilt, its rate, UAV tilt, its rate, its acceleration
    state: tuple[float, float, float, float, float] = (100.0, 80.0, 1.0, 0.1, 0.0)
    tilt_max: float = 0.3  # sine of the largest tilt of a thrust
    attitude_error_max: float = 0.6  # rad; of an attitude that is wrong on board, to which it is compensated
    setpoint: float = 200.0  # weight of the tilt set-point: a lower one needs telemetry that is less than 0.2 s late


@dataclass(frozen=True, eq=False, repr=False)
class ControllerSettings(SettingsTable):
    """Adaptation to the load, and the largest errors that are answered at once."""

    period: float = derived(1.0 / CONTROL_RATE)
    """Control period (s): of ``rates.control``."""
    wind: WindSettings = derived(WindSettings())
    """Table ``estimation.wind``."""
    ground: GroundControlSettings = derived(GroundControlSettings())
    """Table ``control.ground``."""
    # s; with which the reference follows the estimated load: slower than the estimate itself
    load_time_constant: float = 0.5
    # least and largest weight of the payload that is learnt, over that of the system file
    mass_share: tuple[float, float] = (0.05, 2.0)
    # largest level force that the reference leans against: on the payload over its weight, on a UAV over its thrust
    force_limit: float = 0.4
    # the same where wind explains the force: of drag, and of drag and disturbance force together
    drag_limit: float = 0.65
    # m, m/s; the same in place of the two below where wind explains the force: it has displaced the payload
    position_error_limit_in_wind: float = 1.0
    velocity_error_limit_in_wind: float = 1.0
    upright_time_constant: float = 0.5  # s; with which links come upright over a payload on the ground
    position_error_limit: float = 0.3  # m; a position error of the payload is answered as if it were at most this
    velocity_error_limit: float = 0.6  # m/s; the same of its velocity
