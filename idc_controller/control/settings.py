"""Settings of the tracking controllers: the MPC's horizon, limits and weights, and how the load is learnt."""

from dataclasses import dataclass

import numpy as np

from idc_controller.errors import ParameterError
from idc_controller.estimation.settings import WindSettings
from idc_controller.settings import derived, setting

Triple = tuple[float, float, float]


@dataclass(frozen=True)
class MpcWeights:
    """Diagonal of the MPC's cost, a unit of squared error each; lists are x, y, z or roll, pitch, yaw."""

    position: Triple = setting((60.0, 60.0, 80.0), "1/m2", "weight of the payload's position", ge=0.0)
    velocity: Triple = setting((20.0, 20.0, 20.0), "s2/m2", "weight of the payload's velocity", ge=0.0)
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
    tilt_setpoint: float = setting(8.0, "1/rad2", "weight of a tilt set-point", gt=0.0)
    thrust_setpoint: float = setting(0.02, "1/N2", "weight of a thrust set-point", gt=0.0)


@dataclass(frozen=True)
class MpcSettings:
    """Horizon, limits and weights of the MPC. Angles in rad."""

    period: float = derived(0.05)
    """Control period (s): ``rates.control``."""
    horizon: int = derived(20)
    """Stages N_p of the horizon: ``controller.horizon``."""
    moves: tuple[int, ...] = derived((1, 1, 1, 2, 2, 3, 4, 6))
    """Stages over which each move is held; they sum to the horizon."""
    constraint_stages: tuple[int, ...] = derived((1, 4, 7, 10, 13, 16, 19))
    """Stages at which states are constrained."""
    payload_tilt_limit: float = derived(float(np.radians(5.0)))
    """Largest roll, pitch and yaw of the payload (rad, eq:consOsc): ``controller.payload_tilt_limit_deg``."""
    uav_tilt_limit: float = derived(float(np.radians(35.0)))
    """Largest tilt set-point (rad): ``controller.uav_tilt_limit_deg``."""
    thrust_min: float = setting(1.0, "N", "least thrust set-point of a UAV", ge=0.0)
    thrust_share_max: float = setting(
        0.95, "", "largest thrust set-point, as a share of the largest thrust", gt=0, le=1
    )
    separation_share: float = setting(
        0.425, "", "part of the gap between neighbouring rotor discs in hover that has to stay open", ge=0.0, le=1.0
    )
    slack_linear: float = setting(1e3, "", "linear cost of exceeding a limit of the state", gt=0.0)
    slack_quadratic: float = setting(1e4, "", "quadratic cost of exceeding a limit of the state", gt=0.0)
    weights: MpcWeights = derived(MpcWeights())
    """Of ``controller.weights``."""

    def __post_init__(self) -> None:
        if sum(self.moves) != self.horizon or min(self.moves) < 1:
            raise ParameterError(f"moves {self.moves} do not sum to the horizon of {self.horizon} stages")
        if not all(1 <= k <= self.horizon for k in self.constraint_stages):
            raise ParameterError(f"constraint stages {self.constraint_stages} leave 1 .. {self.horizon}")


@dataclass(frozen=True)
class GroundControlSettings:
    """Regulator that keeps the UAVs upright over a payload on the ground."""

    design_share: float = setting(0.8, "", "thrust for which the gain is designed, over hover thrust", gt=0.0)
    state: tuple[float, float, float, float, float] = setting(
        (100.0, 80.0, 1.0, 0.1, 0.0), "", "weights of link tilt, its rate, UAV tilt, its rate, its acceleration", ge=0.0
    )
    setpoint: float = setting(
        200.0, "", "weight of the tilt set-point: a lower one needs telemetry that is less than 0.2 s late", gt=0.0
    )


@dataclass(frozen=True)
class ControllerSettings:
    """How fast the load is learnt and how far an error is answered at once."""

    period: float = derived(0.05)
    """Control period (s): of ``rates.control``."""
    horizon: int = derived(20)
    """Stages over which the tracker needs the reference: ``controller.horizon``."""
    wind: WindSettings = derived(WindSettings())
    """Table ``estimation.wind``."""
    ground: GroundControlSettings = derived(GroundControlSettings())
    """Table ``control.ground``."""
    load_time_constant: float = setting(
        0.5, "s", "with which the reference follows the estimated load: slower than the estimate itself", gt=0.0
    )
    mass_share: tuple[float, float] = setting(
        (0.5, 2.0), "", "least and largest payload mass that is learnt, over that of the system file", gt=0.0
    )
    force_limit: float = setting(
        0.4, "", "largest disturbance force that the reference leans against, over the payload's weight", ge=0.0
    )
    drag_limit: float = setting(
        0.65, "", "the same where wind explains the force: of drag, and of drag and disturbance force together", ge=0.0
    )
    upright_time_constant: float = setting(
        0.5, "s", "with which links come upright over a payload on the ground", gt=0.0
    )
    position_error_limit: float = setting(
        0.3, "m", "a position error of the payload is answered as if it were at most this", gt=0.0
    )
    velocity_error_limit: float = setting(0.6, "m/s", "the same of its velocity", gt=0.0)
