"""Parameters of a free vehicle beside those of any: PX4's names, defaults and ranges."""

from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import INTEGER, Parameter
from vehicle_sim.autopilot.airframe import Airframe

CRUISE_SPEED = "MPC_XY_CRUISE"
SPEED_MAX = "MPC_XY_VEL_MAX"
CLIMB_MAX = "MPC_Z_VEL_MAX_UP"
SINK_MAX = "MPC_Z_VEL_MAX_DN"
TAKEOFF_SPEED = "MPC_TKO_SPEED"
ACCEPTANCE_RADIUS = "NAV_ACC_RAD"
RETURN_ALTITUDE = "RTL_RETURN_ALT"
DESCEND_ALTITUDE = "RTL_DESCEND_ALT"
RETURN_NEAR = "RTL_MIN_DIST"
RETURN_TYPE = "RTL_TYPE"
FAILSAFE_DELAY = "COM_FAIL_ACT_T"
POSITION_LOSS = "COM_POSCTL_NAVL"
FENCE_ACTION = "GF_ACTION"
FENCE_DISTANCE = "GF_MAX_HOR_DIST"
FENCE_HEIGHT = "GF_MAX_VER_DIST"
HOVER_THRUST = "MPC_THR_HOVER"

_ACTIONS = (0, 1, 2, 3, 5)
"""PX4's of a fence without termination (4)."""


def free_parameters(airframe: Airframe) -> list[Parameter]:
    """Return the parameters, which take the place of those of the same names."""
    hover = airframe.mass * airframe.g / airframe.rotors.thrust_max
    return [
        _real(CRUISE_SPEED, 5.0, (0.1, 20.0), "horizontal speed that is flown by itself (m/s)"),
        _real(SPEED_MAX, 12.0, (0.1, 20.0), "largest horizontal speed (m/s)"),
        _real(CLIMB_MAX, 3.0, (0.5, 8.0), "largest speed upwards (m/s)"),
        _real(SINK_MAX, 1.5, (0.5, 4.0), "largest speed downwards (m/s)"),
        _real(TAKEOFF_SPEED, 1.5, (0.1, 5.0), "speed of the climb of a take-off (m/s)"),
        _real(px4.PARAM_LAND_SPEED, 0.7, (0.1, 5.0), "speed of the last part of a landing (m/s)"),
        _real(ACCEPTANCE_RADIUS, 2.0, (0.05, 200.0), "horizontal distance at which a waypoint is reached (m)"),
        _real(RETURN_ALTITUDE, 30.0, (0.0, 150.0), "height above home at which it returns (m)"),
        _real(DESCEND_ALTITUDE, 10.0, (0.0, 100.0), "height above home from which it lands (m)"),
        _real(RETURN_NEAR, 10.0, (0.5, 100.0), "distance of home below which it climbs no higher than that (m)"),
        Parameter(RETURN_TYPE, 0, INTEGER, (0, 0), "0: to the nearest of home and the rally points"),
        Parameter(
            px4.PARAM_LINK_LOSS_ACTION,
            px4.LINK_LOSS_NOTHING,
            INTEGER,
            (px4.LINK_LOSS_NOTHING, px4.LINK_LOSS_LAND),
            "without a ground station: 0 nothing, 1 hold, 2 return, 3 land",
        ),
        _real(FAILSAFE_DELAY, 5.0, (0.0, 25.0), "hold after set-points were lost, before it returns (s)"),
        Parameter(POSITION_LOSS, 1, INTEGER, (1, 1), "without a position: 1, descend"),
        Parameter(
            FENCE_ACTION,
            2,
            INTEGER,
            (0, 5),
            "beyond the fence: 0 nothing, 1 warning, 2 hold, 3 return, 5 land",
            _ACTIONS,
        ),
        _real(FENCE_DISTANCE, 0.0, (0.0, 10000.0), "largest horizontal distance from home (m); 0: any"),
        _real(FENCE_HEIGHT, 0.0, (0.0, 10000.0), "largest height above home (m); 0: any"),
        _real(px4.PARAM_SETPOINT_LOSS, 1.0, (0.1, 60.0), "without set-points in OFFBOARD until it holds (s)"),
        Parameter(HOVER_THRUST, hover, meaning="share of the largest thrust that hovers"),
    ]


def _real(name: str, value: float, limits: tuple[float, float], meaning: str) -> Parameter:
    return Parameter(name, value, limits=limits, meaning=meaning)
