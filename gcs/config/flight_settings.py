"""The numbers that decide how a flight is run: failsafes, alarms, take-off and landing, clocks."""

import math
from dataclasses import dataclass, field

from idc_controller.settings import SettingsTable, Share, setting


@dataclass(frozen=True, eq=False, repr=False)
class FailsafeSettings(SettingsTable):
    """Thresholds of the conditions in :mod:`gcs.flight.failsafe`."""

    connect_timeout: float = setting(10.0, "s", "until every vehicle has sent all that a flight needs", gt=0.0)
    duplicate_id_window: float = 2.0  # s; in which one system id is heard from two addresses: two HEARTBEATs of each
    telemetry_timeout: float = setting(
        0.46, "s", "age at which telemetry is lost, and set-point loss of the vehicles (COM_OF_LOSS_T)", ge=0.1, le=60.0
    )
    data_link_timeout: float = setting(3.0, "s", "without any message of any vehicle, ends control", gt=0.0)
    latency_limit: float = setting(0.11, "s", "one-way link latency above which the loop cannot be closed", gt=0.0)
    overrun_limit: float = 1.6  # control periods between steps; the loop was held at 1.7, and lost at 1.95
    # s; one way, that is flown whatever share of the set-points is lost
    latency_any_loss: float = 0.05
    # s; mean age that losses may add to set-points, at `latency_limit` and at `latency_any_loss`: a third of the margin
    loss_age: tuple[float, float] = (0.007, 0.016)
    timesync_timeout: float = 1.5  # s; without an answer: at 50 % loss both ways one in 75 such times without copies
    latency_window: float = 0.3  # s; in which every round trip must be late, or half of all usually
    parameter_tolerance: float = 0.01  # relative error of a vehicle's parameter before take-off
    placement_tolerance: float = 0.3  # m; from a vehicle to its place over the payload, before take-off
    tilt_limit: float = setting(
        math.radians(45.0), "rad", "payload tilt at which control is lost, or it is overturned by its own unit", gt=0.0
    )
    deviation_limit: float = setting(
        3.5,
        "m",
        "of half of the vehicles from their places in the plan: wind of 4 m/s at lift-off displaces by up to 2.4 m",
        gt=0.0,
    )
    deviation_time: float = 0.2  # s; for which they must be that far off
    confirming_deviation: float = 0.4  # m; of one vehicle, which confirms that the payload's unit reports it overturned
    wind_drag: float = setting(
        0.38, "", "share of the payload's weight; level drag on it at rest above which the flight is ended", gt=0.0
    )
    # rad; of a vehicle on board, by the force that it pulls aside with: less is compensated
    attitude_error: float = 0.09
    attitude_certainty: Share = 0.99  # probability, by the filter's covariance, that it is wrong by more than that
    pad_attitude_error: float = 0.05  # rad; between axes of vehicle and payload on the pad: how level cradles are
    tilt_time: float = 0.5  # s; for which the tilt must exceed its limit
    descent_timeout: float = 15.0  # s; after the descent's planned end, without a touchdown
    arm_timeout: float = 12.0  # s; until all vehicles are in OFFBOARD and armed
    disarm_timeout: float = 10.0  # s; until all are disarmed: heartbeats come once a second, and some are lost
    landing_timeout: float = setting(120.0, "s", "until all have landed autonomously", gt=0.0)
    landing_wait: float = setting(60.0, "s", "above a landing place that is taken, before the return home", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class MonitorSettings(SettingsTable):
    """Thresholds of the detectors in :mod:`gcs.flight.detectors`."""

    hold_time: float = 2.0  # s; a condition that is absent for longer raises a new alarm
    missed_samples: int = 5  # telemetry periods without a sample are a timeout; at 1 % loss that is one in 1e10
    event_count: int = 3  # losses, duplicates, ... in the window that are an alarm
    # s; in which events are counted; at 0.1 % loss three of its 50 messages are lost once in 5e4
    event_window: float = 2.0
    setpoint_window: float = 5.0  # s; the same for set-points: after the first loss copies are sent
    latency_periods: float = 0.5  # one-way link latency that is an alarm, in control periods
    jitter_periods: float = 0.25  # its variation that is an alarm, in control periods
    clock_error: float = 0.01  # s; movement of a clock in its window that no latency explains: 20 times a bad quartz
    clock_window: float = 5.0  # s; in which the bounds of a clock's offset are compared
    clock_segment: float = 1.0  # s; of TIMESYNC exchanges that are compared with an earlier one
    # in both segments at least: random latencies order them by chance once in C(10, 5) squared
    clock_exchanges: int = 5
    # share of the differences of latencies that are a queue's: of latencies at random, of 30 datagrams once in 1e5
    queue_explained: Share = 0.85
    # share of the link's rate that is used at least: below, datagrams wait for a sixth of their own time (M/D/1)
    queue_load: float = 0.25
    queue_datagrams: int = 30  # whose latencies are compared at least
    queue_interval: float = 0.25  # s; between two such comparisons, which cost 2 ms
    manoeuvre_tilt: float = 0.1  # rad; change of tilt set-points in one step, beyond the attitude loop's linear model
    manoeuvre_time: float = 2.0  # s; after such a step, without alarms from UAV attitudes
    noise_factor: float = 4.0  # of the variances of all sensors; clean flights reach 2
    # of the force's error variance, that its estimate has without a force; the filter comes to 0.4
    force_share: float = 0.5
    mass_time: float = 5.0  # s; from the climb after grippers were commanded until the payload is weighed
    mass_error: float = 0.05  # relative error of the estimated mass then, from flights in wind


@dataclass(frozen=True, eq=False, repr=False)
class TakeoffLandingSettings(SettingsTable):
    """Spool-up, touchdown detection and spool-down."""

    settle_time: float = 0.5  # s; of telemetry averaged on the ground before take-off
    position_samples: int = 100  # of each source, averaged on the ground
    offboard_delay: float = 0.5  # s; of set-points before OFFBOARD is commanded
    spool_up_time: float = 2.5  # s; from idle to hover thrust
    spool_down_time: float = 2.0  # s; from hover thrust to idle
    unload_time: float = 0.3  # s; in which the ground takes over the weight of a payload that has touched down
    friction: Share = 0.5  # least coefficient of friction of the ground: it holds a payload in the strongest wind
    least_weight: Share = 0.37  # of the weight that was learnt, of a payload that loses its load where it is not learnt
    upright_lean: float = 0.05  # sine of a link's tilt that stays upright without thrust
    # m/s; of a payload at rest on the ground: six standard deviations of its unit's velocity
    rest_speed: float = 0.05
    lean_time: float = 1.0  # s; a link that moves on at its rate must be upright for so long, too
    lean_time_unlocated: float = 3.0  # s; the same of one without a position, whose rate is known less exactly
    upright_timeout: float = 5.0  # s; for links to come upright before the thrust fades
    touch_depth: float = 0.06  # m; of the reference below a payload that is on the ground
    touch_speed: float = 0.05  # m/s; vertical, below which it is at rest
    touch_height_near: float = 0.08  # m; a pad's height, where a bouncing payload is on the ground
    touch_depth_near: float = 0.03  # m; of the reference below it there
    touch_steps: int = 4  # control steps in a row that are a touchdown
    touch_height: float = 1.0  # m; above which nothing is a touchdown
    lift_off_lag: float = 0.05  # m; of a climb behind its plan on the ground, from which the thrust grows on
    clear_height: float = 0.3  # m; below which the ground may carry part of the load
    # m; below which the load is not learnt: a pad, and the lowest corner of a payload tilted by 5 deg
    learn_height: float = 0.15
    landing_overshoot: float = 0.15  # m; below the expected ground, where a descent aims
    slow_height: float = 1.0  # m; above the ground, below which a descent is slow
    slow_margin: float = 0.5  # m; above that, from where the whole descent is slow
    hold_speed: float = 0.05  # m/s; of the reference, up to which the phase is hold, not fly
    place_time: float = setting(
        2.0, "s", "on the ground between the unloading of NAV_PAYLOAD_PLACE and the next take-off", ge=0.0
    )
    landing_look_ahead: float = 1.0  # s; before the descent, from when on the landing place must be free
    landing_look_interval: float = 0.2  # s; between looks at the obstacle map of the landing place
    landing_clear_time: float = 2.0  # s; for which a place that was taken must be free
    pad_radius: float = 0.2  # m; about the take-off position, in which a landing is on the pad


@dataclass(frozen=True, eq=False, repr=False)
class TimingSettings(SettingsTable):
    """Timers of the ground station and the estimate of team time."""

    heartbeat_interval: float = 1.0  # s; between heartbeats of the ground
    timesync_interval: float = 0.1  # s; between TIMESYNC requests
    clock_step: float = 0.5  # s; largest correction of team time in flight; more is a reboot
    clock_settled: float = 0.2  # s; after a clock jump, without obstacle detections
    lead_rate: float = 0.02  # s/s; at which team time follows a clock that is ahead
    lead_limit: float = 0.01  # s; by which it follows at once at most
    latency_steps: int = 20  # control steps whose compute latency is averaged
    simultaneous: float = 0.004  # s; difference of set-point delays that needs no waiting


@dataclass(frozen=True, eq=False, repr=False)
class DriverSettings(SettingsTable):
    """How long the drivers wait, in wall time, for the simulated world and for datagrams."""

    join_interval: float = 0.5  # s; after which an unanswered request to join the world is repeated
    tick_timeout: float = 20.0  # s; without a tick, after which the simulated world is lost
    wait_max: float = 0.1  # s; for datagrams in real time, so that an interrupt is noticed
    landing_timeout: float = 60.0  # s; for vehicle-sim to land what is in the air after the flight
    end_timeout: float = 10.0  # s; after that, for vehicle-sim to close its records


@dataclass(frozen=True, eq=False, repr=False)
class FlightSettings(SettingsTable):
    """Settings of a flight."""

    failsafe: FailsafeSettings = field(default_factory=FailsafeSettings)
    monitor: MonitorSettings = field(default_factory=MonitorSettings)
    takeoff_landing: TakeoffLandingSettings = field(default_factory=TakeoffLandingSettings)
    timing: TimingSettings = field(default_factory=TimingSettings)


DEFAULTS = FlightSettings()
