"""The numbers that decide how a flight is run: failsafes, alarms, take-off and landing, clocks."""

import math
from dataclasses import dataclass, field

from idc_controller.settings import SettingsTable, setting


@dataclass(frozen=True, eq=False, repr=False)
class FailsafeSettings(SettingsTable):
    """Thresholds of the conditions in :mod:`gcs.flight.failsafe`."""

    connect_timeout: float = setting(10.0, "s", "until every vehicle has sent all that a flight needs", gt=0.0)
    duplicate_id_window: float = setting(
        2.0, "s", "in which one system id is heard from two addresses: two HEARTBEATs of each", gt=0.0
    )
    telemetry_timeout: float = setting(
        0.46, "s", "age at which telemetry is lost, and set-point loss of the vehicles (COM_OF_LOSS_T)", ge=0.1, le=60.0
    )
    data_link_timeout: float = setting(3.0, "s", "without any message of any vehicle, ends control", gt=0.0)
    latency_limit: float = setting(0.11, "s", "one-way link latency above which the loop cannot be closed", gt=0.0)
    latency_window: float = setting(0.3, "s", "in which every round trip must be late, or half of all usually", gt=0.0)
    parameter_tolerance: float = setting(0.01, "", "relative error of a vehicle's parameter before take-off", ge=0.0)
    placement_tolerance: float = setting(
        0.3, "m", "from a vehicle to its place over the payload, before take-off", gt=0.0
    )
    tilt_limit: float = setting(
        math.radians(45.0), "rad", "payload tilt at which control is lost, or it is overturned by its own unit", gt=0.0
    )
    deviation_limit: float = setting(
        3.5,
        "m",
        "of half of the vehicles from their places in the plan: wind of 4 m/s at lift-off displaces by up to 2.4 m",
        gt=0.0,
    )
    deviation_time: float = setting(0.2, "s", "for which they must be that far off", ge=0.0)
    confirming_deviation: float = setting(
        0.4, "m", "of one vehicle, which confirms that the payload's unit reports it overturned", gt=0.0
    )
    tilt_time: float = setting(0.5, "s", "for which the tilt must exceed its limit", ge=0.0)
    descent_timeout: float = setting(15.0, "s", "after the descent's planned end, with the payload still high", gt=0.0)
    arm_timeout: float = setting(12.0, "s", "until all vehicles are in OFFBOARD and armed", gt=0.0)
    disarm_timeout: float = setting(
        10.0, "s", "until all are disarmed: heartbeats come once a second, and some are lost", gt=0.0
    )
    landing_timeout: float = setting(120.0, "s", "until all have landed autonomously", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class MonitorSettings(SettingsTable):
    """Thresholds of the detectors in :mod:`gcs.flight.detectors`."""

    hold_time: float = setting(2.0, "s", "a condition that is absent for longer raises a new alarm", ge=0.0)
    missed_samples: int = setting(
        5, "", "telemetry periods without a sample are a timeout; at 1 % loss that is one in 1e10", ge=1
    )
    event_count: int = setting(3, "", "losses, duplicates, ... in the window that are an alarm", ge=1)
    event_window: float = setting(
        2.0, "s", "in which events are counted; at 0.1 % loss three of its 50 messages are lost once in 5e4", gt=0.0
    )
    setpoint_window: float = setting(5.0, "s", "the same for set-points: after the first loss copies are sent", gt=0.0)
    latency_periods: float = setting(0.5, "", "one-way link latency that is an alarm, in control periods", gt=0.0)
    jitter_periods: float = setting(0.25, "", "its variation that is an alarm, in control periods", gt=0.0)
    clock_error: float = setting(
        0.01, "s", "movement of a clock in its window that no latency explains: 20 times a bad quartz", gt=0.0
    )
    clock_window: float = setting(5.0, "s", "in which the bounds of a clock's offset are compared", gt=0.0)
    clock_segment: float = setting(1.0, "s", "of TIMESYNC exchanges that are compared with an earlier one", gt=0.0)
    clock_exchanges: int = setting(
        5, "", "in both segments at least: random latencies order them by chance once in C(10, 5) squared", ge=1
    )
    queue_explained: float = setting(
        0.85,
        "",
        "share of the differences of latencies that are a queue's: of latencies at random, of 30 datagrams once in 1e5",
        gt=0.0,
        lt=1.0,
    )
    queue_load: float = setting(
        0.25,
        "",
        "share of the link's rate that is used at least: below, datagrams wait for a sixth of their own time (M/D/1)",
        gt=0.0,
    )
    queue_datagrams: int = setting(30, "", "whose latencies are compared at least", ge=10)
    queue_interval: float = setting(0.25, "s", "between two such comparisons, which cost 2 ms", gt=0.0)
    manoeuvre_tilt: float = setting(
        0.1, "rad", "change of tilt set-points in one step, beyond the attitude loop's linear model", gt=0.0
    )
    manoeuvre_time: float = setting(2.0, "s", "after such a step, without alarms from UAV attitudes", ge=0.0)
    noise_factor: float = setting(4.0, "", "of the variances of all sensors; clean flights reach 2", gt=1.0)


@dataclass(frozen=True, eq=False, repr=False)
class TakeoffLandingSettings(SettingsTable):
    """Spool-up, touchdown detection and spool-down."""

    settle_time: float = setting(0.5, "s", "of telemetry averaged on the ground before take-off", ge=0.0)
    position_samples: int = setting(100, "", "of each source, averaged on the ground", ge=1)
    offboard_delay: float = setting(0.5, "s", "of set-points before OFFBOARD is commanded", ge=0.0)
    spool_up_time: float = setting(2.5, "s", "from idle to hover thrust", gt=0.0)
    spool_down_time: float = setting(2.0, "s", "from hover thrust to idle", gt=0.0)
    standing_share: float = setting(
        0.8, "", "of the hover thrust, with the payload on the ground and the links taut", gt=0.0, lt=1.0
    )
    upright_lean: float = setting(0.05, "", "sine of a link's tilt that stays upright without thrust", gt=0.0)
    upright_timeout: float = setting(5.0, "s", "for links to come upright before the thrust fades", ge=0.0)
    touch_depth: float = setting(0.06, "m", "of the reference below a payload that is on the ground", gt=0.0)
    touch_speed: float = setting(0.05, "m/s", "vertical, below which it is at rest", gt=0.0)
    touch_height_near: float = setting(0.08, "m", "a pad's height, where a bouncing payload is on the ground", gt=0.0)
    touch_depth_near: float = setting(0.03, "m", "of the reference below it there", gt=0.0)
    touch_steps: int = setting(4, "", "control steps in a row that are a touchdown", ge=1)
    touch_grace: float = setting(3.0, "s", "after the descent's planned end, that are a touchdown as well", ge=0.0)
    touch_height: float = setting(1.0, "m", "above which nothing is a touchdown", gt=0.0)
    clear_height: float = setting(0.3, "m", "below which the ground may carry part of the load", gt=0.0)
    landing_overshoot: float = setting(0.15, "m", "below the expected ground, where a descent aims", gt=0.0)
    slow_height: float = setting(1.0, "m", "above the ground, below which a descent is slow", gt=0.0)
    slow_margin: float = setting(0.5, "m", "above that, from where the whole descent is slow", ge=0.0)
    hold_speed: float = setting(0.05, "m/s", "of the reference, up to which the phase is hold, not fly", ge=0.0)
    pad_radius: float = setting(0.2, "m", "about the take-off position, in which a landing is on the pad", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class TimingSettings(SettingsTable):
    """Timers of the ground station and the estimate of team time."""

    heartbeat_interval: float = setting(1.0, "s", "between heartbeats of the ground", gt=0.0)
    timesync_interval: float = setting(0.1, "s", "between TIMESYNC requests", gt=0.0)
    clock_step: float = setting(0.5, "s", "largest correction of team time in flight; more is a reboot", gt=0.0)
    clock_settled: float = setting(0.2, "s", "after a clock jump, without obstacle detections", ge=0.0)
    lead_rate: float = setting(0.02, "s/s", "at which team time follows a clock that is ahead", ge=0.0)
    lead_limit: float = setting(0.01, "s", "by which it follows at once at most", ge=0.0)
    latency_steps: int = setting(20, "", "control steps whose compute latency is averaged", ge=1)
    simultaneous: float = setting(0.004, "s", "difference of set-point delays that needs no waiting", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class FlightSettings(SettingsTable):
    """Settings of a flight."""

    failsafe: FailsafeSettings = field(default_factory=FailsafeSettings)
    monitor: MonitorSettings = field(default_factory=MonitorSettings)
    takeoff_landing: TakeoffLandingSettings = field(default_factory=TakeoffLandingSettings)
    timing: TimingSettings = field(default_factory=TimingSettings)


DEFAULTS = FlightSettings()
