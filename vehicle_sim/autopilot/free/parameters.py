"""Parameters of a free vehicle beside those of any: PX4's names, defaults and ranges."""

from gcs.mavlink import px4
from gcs.mavlink.services.parameter_table import INTEGER, Parameter
from vehicle_sim.autopilot.airframe import Airframe

CRUISE_SPEED = "MPC_XY_CRUISE"  #: m/s, horizontal, flown by itself
SPEED_MAX = "MPC_XY_VEL_MAX"  #: m/s, horizontal
CLIMB_MAX = "MPC_Z_VEL_MAX_UP"  #: m/s
SINK_MAX = "MPC_Z_VEL_MAX_DN"  #: m/s
TAKEOFF_SPEED = "MPC_TKO_SPEED"  #: m/s
ACCEPTANCE_RADIUS = "NAV_ACC_RAD"  #: m, horizontal
RETURN_ALTITUDE = "RTL_RETURN_ALT"  #: m above home
DESCEND_ALTITUDE = "RTL_DESCEND_ALT"  #: m above home, from which it lands
RETURN_NEAR = "RTL_MIN_DIST"  #: m from home within which it climbs no higher than it is far, as PX4's cone of 45 deg
LINK_LOSS_ACTION = "NAV_DLL_ACT"  #: 0 nothing, 1 hold, 2 return, 3 land
FAILSAFE_DELAY = "COM_FAIL_ACT_T"  #: s, hold after set-points are lost, before it returns
FENCE_ACTION = "GF_ACTION"  #: at a breach of the fence: 0 nothing, 1 warning, 2 hold, 3 return, 5 land
FENCE_DISTANCE = "GF_MAX_HOR_DIST"  #: m from home, horizontal; 0: any
FENCE_HEIGHT = "GF_MAX_VER_DIST"  #: m above home; 0: any
RETURN_TYPE = "RTL_TYPE"  #: 0, to the nearest of home and the rally points
POSITION_LOSS = "COM_POSCTL_NAVL"  #: without a position: 1, descend
HOVER_THRUST = "MPC_THR_HOVER"  #: share of the largest thrust that hovers, read-only


def free_parameters(airframe: Airframe) -> list[Parameter]:
    """Return the parameters, which take the place of those of the same names."""
    return [
        Parameter(CRUISE_SPEED, 5.0, limits=(0.1, 20.0)),
        Parameter(SPEED_MAX, 12.0, limits=(0.1, 20.0)),
        Parameter(CLIMB_MAX, 3.0, limits=(0.5, 8.0)),
        Parameter(SINK_MAX, 1.5, limits=(0.5, 4.0)),
        Parameter(TAKEOFF_SPEED, 1.5, limits=(0.1, 5.0)),
        Parameter(px4.PARAM_LAND_SPEED, 0.7, limits=(0.1, 5.0)),
        Parameter(ACCEPTANCE_RADIUS, 2.0, limits=(0.05, 200.0)),
        Parameter(RETURN_ALTITUDE, 30.0, limits=(0.0, 150.0)),
        Parameter(DESCEND_ALTITUDE, 10.0, limits=(0.0, 100.0)),
        Parameter(RETURN_NEAR, 10.0, limits=(0.5, 100.0)),
        Parameter(LINK_LOSS_ACTION, 0, INTEGER, (0, 3)),
        Parameter(FAILSAFE_DELAY, 5.0, limits=(0.0, 25.0)),
        Parameter(FENCE_ACTION, 2, INTEGER, (0, 5), values=(0, 1, 2, 3, 5)),
        Parameter(FENCE_DISTANCE, 0.0, limits=(0.0, 10000.0)),
        Parameter(FENCE_HEIGHT, 0.0, limits=(0.0, 10000.0)),
        Parameter(RETURN_TYPE, 0, INTEGER, (0, 0)),
        Parameter(POSITION_LOSS, 1, INTEGER, (1, 1), "without a position: 1, descend"),
        Parameter(px4.PARAM_SETPOINT_LOSS, 1.0, limits=(0.1, 60.0)),
        Parameter(HOVER_THRUST, airframe.mass * airframe.g / airframe.rotors.thrust_max),
    ]
