"""The numbers that decide what a vehicle does on board, and how it serves its links."""

from __future__ import annotations

from dataclasses import dataclass, field

from gcs.config.flight_settings import DEFAULTS
from gcs.mavlink.settings import MissionTransferSettings, PeerSettings
from idc_controller.settings import SettingsTable, Share, derived, setting
from idc_controller.trajectory.settings import BrakingSettings


@dataclass(frozen=True, eq=False, repr=False)
class ArmingSettings(SettingsTable):
    """Limits of the prearm checks."""

    tilt_max_deg: float = setting(
        60.0, "deg", "tilt above which the vehicle is taken to lie on its side", gt=0.0, lt=180.0
    )
    speed_max: float = setting(1.0, "m/s", "speed above which the vehicle is not armed", gt=0.0)
    rate_max: float = setting(2.0, "rad/s", "body rate above which the vehicle is not armed", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class VehicleFailsafeSettings(SettingsTable):
    """Defaults of the failsafe parameters, which the ground may set, and what a failsafe follows."""

    setpoint_loss: float = derived(DEFAULTS.failsafe.telemetry_timeout)
    """COM_OF_LOSS_T (s): without set-points in OFFBOARD until it brakes; ``flight.failsafe.telemetry_timeout``."""
    land_delay: float = setting(5.0, "s", "CLFT_LAND_DELAY: from that hold to the descent", ge=0.0, le=3600.0)
    link_loss: int = setting(
        10, "s", "COM_DL_LOSS_T: without a heartbeat of the ground until a holding vehicle descends", ge=5, le=300
    )
    stop_plan_age: float = 0.62  # s; of the ground's stop plan when it is begun, beyond what set-point loss explains
    # m; from the stop plan within which it is followed: farther away it does not fit the vehicle
    stop_plan_distance: float = 2.0
    # m; from the vehicle's path within which a stop plan begins, or it is another's: neighbours are farther apart
    stop_plan_offset: float = 0.5


@dataclass(frozen=True, eq=False, repr=False)
class NavigationSettings(SettingsTable):
    """Estimate of the vehicle's own state while a sensor on board fails."""

    timeout: float = 0.2  # s; without a usable sample until the navigation counts as failed
    stuck_after: int = 3  # samples equal to the digit after which a sensor counts as stuck
    # rad/s; bandwidth of body rates estimated from the attitude: above that of the attitude loop
    rates_bandwidth: float = 30.0
    gap_max: float = 0.05  # s; between samples; after a longer gap that estimate begins anew
    still_force: float = 0.3  # m/s2; by which the specific force of a vehicle that stands differs from gravity
    still_time: float = 0.5  # s; for which it must, until the velocity is taken to be zero
    rates_window: float = 0.1  # s; over which body rates are compared with the change of the attitude
    # standard deviations of the difference of two attitudes by which rates may miss it: chi-square of 3 axes at 1e-9
    rates_sigmas: float = 6.7
    rates_error: float = 0.01  # rad; by which they may miss it without noise: the samples are integrated one by one
    rates_refused: float = 2.0  # s; for which rates that miss it are not used
    alignment_time: float = 0.5  # s; time constant with which the inertial attitude is aligned with the measured one


@dataclass(frozen=True, eq=False, repr=False)
class SetpointSettings(SettingsTable):
    """Set-points of the ground: what is flown of them, and which are refused."""

    hold: float = 0.1  # s; the last set-point is flown; then the mean of the last: longer than set-points are apart
    mean_over: float = 0.2  # s; set-points that the mean is taken of
    rate_max: float = 20.0  # rad/s; largest body rate of a set-point
    quaternion_norm_error_max: float = 0.1  # deviation of a set-point quaternion's norm from 1
    stop_duration_max: float = 60.0  # s; longest stop plan
    stop_speed_max: float = 20.0  # m/s; of a stop plan at its start, and its mean: no team flies as fast


@dataclass(frozen=True, eq=False, repr=False)
class HoldSettings(SettingsTable):
    """Gains and limits of HOLD and LAND.

    There is no vertical integral: four altitudes over-constrain a rigid payload, and integrals would load one link
    against another.
    """

    horizontal_kp: float = 1.6  # 1/s2; horizontal position gain
    horizontal_kd: float = 2.2  # 1/s; horizontal velocity gain
    horizontal_ki: float = 0.3  # 1/s3; horizontal integral gain: an attitude may drift
    integral_max: float = 2.5  # m/s2; largest integral part
    # s; longer than a link takes to swing back, and so short that the drift of a reckoned velocity (by 0.2 deg of
    # attitude error) stays at 0.1 m/s
    reckoning_washout: float = 3.0
    vertical_kp: float = 3.2  # 1/s2; altitude gain
    vertical_kd: float = 4.5  # 1/s; vertical velocity gain
    horizontal_max: float = 0.35  # g; largest horizontal acceleration
    vertical_max: float = 0.35  # g; largest acceleration upwards; the least thrust bounds it downwards
    step_max: float = 0.1  # s; longest time between samples that the integral covers
    descent_ramp: float = 1.0  # s; until a descent has reached its speed
    unload_time: float = 0.2  # s; in which a vehicle hands over a payload that stands: an unknown force pulls it aside
    land_speed: float = setting(0.5, "m/s", "MPC_LAND_SPEED: speed of the descent", ge=0.1, le=1.0)
    braking: BrakingSettings = derived(BrakingSettings())
    """Braking of a vehicle without a stop plan, as of the team: by ``guidance`` and ``motion``."""


@dataclass(frozen=True, eq=False, repr=False)
class LandDetectorSettings(SettingsTable):
    """Conditions of a vehicle in the air and of one on the ground.

    On the ground its payload stands, and carries it: it neither rises nor sinks although its thrust is below its own
    weight. In the air it would sink at 1 m/s2 with :attr:`supported_thrust`, and faster with any payload.
    """

    lifted: float = 0.15  # m; above where it was armed: the vehicle is in the air
    vertical_speed_max: float = 0.1  # m/s; vertical speed of a vehicle on the ground
    horizontal_speed_max: float = 0.15  # m/s; of one whose rotors may stop: PX4's LNDMC_XY_VEL_MAX
    rest_timeout: float = 5.0  # s; after which they stop however it moves
    time: float = 0.5  # s; for which a vehicle must stand
    time_elsewhere: float = 5.0  # s; the same, on its own and not at the altitude where it was armed
    altitude_tolerance: float = 0.5  # m; from the altitude where it was armed: that of landing, or its drift
    touchdown_thrust: Share = 0.85  # share of the hover thrust below which a vehicle that does not sink may stand
    # m/s; sinking below which a descent is stopped: half of its speed, for vehicles may still sink aside
    touchdown_sinking: float = 0.25
    velocity_filter: float = 0.2  # s; time constant of the vertical speed
    altitude_filter: float = 0.1  # s; time constant of the altitude
    hover_filter: float = 2.0  # s; time constant of the hover thrust
    supported_thrust: Share = 0.9  # of the own weight: thrust of a vehicle that stands, or is tried for that


@dataclass(frozen=True, eq=False, repr=False)
class FreeFlightSettings(SettingsTable):
    """Flight of a vehicle without a payload; speeds and heights are its parameters."""

    control_interval: float = 0.02  # s; between steps of the position control
    step_max: float = 0.1  # s; longest time between steps that is counted
    position_kp: float = 1.0  # 1/s; horizontal position gain
    vertical_position_kp: float = 1.5  # 1/s; altitude gain
    velocity_kp: float = 2.5  # 1/s; horizontal velocity gain
    velocity_ki: float = 0.5  # 1/s2; its integral
    vertical_velocity_kp: float = 4.0  # 1/s; vertical velocity gain
    vertical_velocity_ki: float = 1.0  # 1/s2; its integral
    integral_max: float = 4.0  # m/s2; largest integral part
    tilt_max_deg: float = 45.0  # deg; largest tilt, PX4's MPC_TILTMAX_AIR
    thrust_min: float = 0.2  # of the weight; least thrust in the air
    thrust_share_max: float = 0.9  # of the largest thrust; the rest is for the attitude
    acceleration: float = 3.0  # m/s2; horizontal, of moving set-points, PX4's MPC_ACC_HOR
    vertical_acceleration: float = 3.0  # m/s2; vertical
    jerk: float = 4.0  # m/s3; of moving set-points, PX4's MPC_JERK_AUTO
    attitude_lag: float = 0.2  # s; with which the attitude follows its set-point
    velocity_rate: float = 4.0  # 1/s; with which their velocity follows
    approach_rate: float = 1.0  # 1/s; speed over distance near the goal
    straight_from: float = 0.5  # m; distance above which the path to a goal is kept straight
    yaw_rate: float = 0.8  # rad/s; of moving set-points, PX4's MPC_YAWRAUTO_MAX
    rest_speed: float = 0.1  # m/s; below which a braking set-point has come to rest
    altitude_radius: float = 0.3  # m; vertical distance within which a goal counts as reached
    heading_from: float = 1.0  # m; horizontal distance from which a vehicle looks ahead to its goal
    landing_slow_below: float = 5.0  # m above home; below which it lands with MPC_LAND_SPEED, PX4's MPC_LAND_ALT2
    landing_slow_from: float = 10.0  # m above home; from which it slows down to that, PX4's MPC_LAND_ALT1
    orbit_radius: float = 10.0  # m; of an orbit without one
    orbit_speed: float = 1.0  # m/s; of an orbit without one, as PX4's
    orbit_radius_min: float = 1.0  # m; PX4's
    orbit_radius_max: float = 1000.0  # m; PX4's
    orbit_radius_error: float = 0.3  # m; horizontal distance to the circle from which an orbit begins
    position_timeout: float = 0.2  # s; in which a position that repeats itself counts as lost, as the other sensors
    position_motion: float = 0.05  # m; that a vehicle must have moved meanwhile
    touchdown_speed: float = 0.15  # m/s; vertical speed of a vehicle that the ground holds
    touchdown_thrust: Share = 0.85  # of the weight; thrust below which the ground carries the rest
    touchdown_time: float = 0.5  # s; for which both must last


@dataclass(frozen=True, eq=False, repr=False)
class AutopilotSettings(SettingsTable):
    """All settings of one autopilot."""

    failsafe: VehicleFailsafeSettings = field(default_factory=VehicleFailsafeSettings)
    arming: ArmingSettings = field(default_factory=ArmingSettings)
    navigation: NavigationSettings = field(default_factory=NavigationSettings)
    setpoints: SetpointSettings = field(default_factory=SetpointSettings)
    hold: HoldSettings = field(default_factory=HoldSettings)
    land_detector: LandDetectorSettings = field(default_factory=LandDetectorSettings)
    free: FreeFlightSettings = field(default_factory=FreeFlightSettings)
    takeoff_altitude: float = setting(
        2.5, "m", "MIS_TAKEOFF_ALT: height of AUTO.TAKEOFF, which is denied to a vehicle on a payload", ge=0.0, le=80.0
    )


@dataclass(frozen=True, eq=False, repr=False)
class StreamIntervals(SettingsTable):
    """Default intervals of the streams: PX4's of its normal mode, or near."""

    heartbeat: float = 1.0  # s; HEARTBEAT of the autopilot and of the payload unit
    sys_status: float = 1.0  # s; SYS_STATUS
    extended_sys_state: float = 0.2  # s; EXTENDED_SYS_STATE
    attitude: float = 0.1  # s; ATTITUDE
    global_position_int: float = 0.2  # s; GLOBAL_POSITION_INT
    gps_raw_int: float = 1.0  # s; GPS_RAW_INT
    home_position: float = 2.0  # s; HOME_POSITION
    battery_status: float = 2.0  # s; BATTERY_STATUS
    vfr_hud: float = 0.5  # s; VFR_HUD
    vibration: float = 10.0  # s; VIBRATION of the autopilot and of the payload unit
    mission_current: float = 1.0  # s; MISSION_CURRENT
    mission_item_reached: float = 1.0  # s; MISSION_ITEM_REACHED, while it is repeated
    system_time: float = 1.0  # s; SYSTEM_TIME
    current_mode: float = 2.0  # s; CURRENT_MODE
    altitude: float = 1.0  # s; ALTITUDE
    highres_imu: float = 1.0  # s; HIGHRES_IMU
    scaled_pressure: float = 1.0  # s; SCALED_PRESSURE
    estimator_status: float = 1.0  # s; ESTIMATOR_STATUS
    rc_channels: float = 1.0  # s; RC_CHANNELS
    position_target_local_ned: float = 1.0  # s; POSITION_TARGET_LOCAL_NED
    position_target_global_int: float = 1.0  # s; POSITION_TARGET_GLOBAL_INT
    orbit_execution_status: float = 1.0  # s; ORBIT_EXECUTION_STATUS, in an orbit
    nav_controller_output: float = 1.0  # s; NAV_CONTROLLER_OUTPUT
    odometry: float = 1.0  # s; ODOMETRY
    servo_output_raw: float = 1.0  # s; SERVO_OUTPUT_RAW
    actuator_output_status: float = 1.0  # s; ACTUATOR_OUTPUT_STATUS


@dataclass(frozen=True, eq=False, repr=False)
class VehicleLinkSettings(PeerSettings):
    """Service of a vehicle to its peers."""

    setpoint_streams_max: int = 16  # senders of set-points served at once
    # s; a set-point older than the newest by less was overtaken on the link; by more, and twice: its clock was set back
    reordering_max: float = 1.0
    intervals: StreamIntervals = field(default_factory=StreamIntervals)
    missions: MissionTransferSettings = field(default_factory=MissionTransferSettings)
