"""Settings of the estimator: noise densities, tests, isolation, adaptation and memory."""

from dataclasses import dataclass, field, replace
from typing import Self

from idc_controller.errors import ParameterError
from idc_controller.settings import SampleCount, SampledSettings, SampleShare, SettingsTable, Share, derived


@dataclass(frozen=True, eq=False, repr=False)
class ProcessNoiseSettings(SettingsTable):
    """Densities of the white noise that drives what the linear model leaves out, per square root of a second."""

    payload_acceleration: float = 0.003  # m/s2/sqrt(s); noise of the payload's acceleration
    payload_angular_acceleration: float = 0.003  # rad/s2/sqrt(s); noise of its angular acceleration
    link_acceleration: float = 0.0015  # 1/s2/sqrt(s); noise of the acceleration of link directions
    uav_jerk: float = 0.85  # 1/s3/sqrt(s); noise of the third derivative of a UAV's thrust direction
    thrust: float = 0.012  # N/s/sqrt(s); noise of the derivative of a UAV's thrust
    force: float = 0.05  # N/sqrt(s); random walk of the disturbance force on the payload
    uav_drag_area: float = 0.03  # m2; drag coefficient times area of a UAV, on which a gust acts as on the payload
    uav_force: float = 0.01  # N/sqrt(s); random walk of the disturbance force common to the UAVs
    per_vehicle_force: float = 0.01  # N; change of each UAV's disturbance force between samples
    mass: float = 0.005  # kg/sqrt(s); random walk of the payload's mass


@dataclass(frozen=True, eq=False, repr=False)
class InitialCovarianceSettings(SettingsTable):
    """Standard deviations of the state of a team that stands on the ground."""

    position: float = 0.05  # m; initial uncertainty of the payload's position
    velocity: float = 0.02  # m/s; initial uncertainty of the payload's velocity
    attitude: float = 0.02  # rad; initial uncertainty of the payload's attitude
    rates: float = 0.02  # rad/s; initial uncertainty of the payload's body rates
    link: float = 0.02  # initial uncertainty of the lateral parts of the link directions
    link_rate: float = 0.02  # 1/s; initial uncertainty of their derivatives
    thrust_direction: float = 0.03  # initial uncertainty of the UAVs' thrust directions
    thrust_direction_rate: float = 0.1  # 1/s; initial uncertainty of their first derivatives
    thrust_direction_acceleration: float = 0.3  # 1/s2; initial uncertainty of their second ones
    thrust: float = 0.5  # N; initial uncertainty of a UAV's thrust
    mass: float = 0.2  # kg; initial uncertainty of the payload's mass about its nominal one
    force: float = 0.3  # N; initial uncertainty of the disturbance force on the payload
    uav_force: float = 0.05  # N; initial uncertainty of the disturbance force common to the UAVs
    per_vehicle_force: float = 0.05  # N; initial uncertainty of each UAV's own disturbance force


@dataclass(frozen=True, eq=False, repr=False)
class CovarianceResetSettings(SampledSettings):
    """Standard deviations added to a prediction that most measurements contradict: what a gust or a blow changes."""

    velocity: float = 0.1  # m/s; added to the payload's velocity
    rates: float = 0.1  # rad/s; added to the payload's body rates
    link_rate: float = 0.03  # 1/s; added to the derivatives of the link directions
    force: float = 3.0  # N; raised uncertainty of the disturbance force on the payload
    payload_time: float = 0.12  # s; of rejections of the payload unit until the prediction is reset
    payload_rejections = SampleCount("payload_time")
    """Rejections of the payload unit in a row after which the prediction is reset rather than the unit."""


@dataclass(frozen=True, eq=False, repr=False)
class MeasurementModelSettings(SettingsTable):
    """Least standard deviations of measurements: the linear model's own errors, whatever the sensor's noise is."""

    position_noise_min: float = 2e-3  # m; least noise assumed of a position
    velocity_noise_min: float = 4e-3  # m/s; least noise assumed of a velocity
    attitude_noise_min: float = 2e-4  # rad; least noise assumed of an attitude
    rates_noise_min: float = 1e-3  # rad/s; least noise assumed of body rates


@dataclass(frozen=True, eq=False, repr=False)
class StuckSensorSettings(SettingsTable):
    """Detection of repeated values, which are no measurements."""

    repeats: int = 2  # repetitions to the digit after which a channel is stuck
    relay_interval: float = 0.02  # s; by which the stamps of relayed copies of one sample differ


@dataclass(frozen=True, eq=False, repr=False)
class ChannelIsolationSettings(SampledSettings):
    """Isolation and restoration of a vehicle's channels."""

    rejection_time: float = 0.48  # s; of rejections less acceptances until a channel is isolated
    acceptance_time: float = 1.0  # s; of consistent samples in a row until it is restored
    restoring_probability: Share = 0.999  # share of nominal samples that are consistent
    unusable_time: float = 0.5  # s; for which a missing, stuck or rejected pose is unusable
    rejections = SampleCount("rejection_time")
    """Rejections less acceptances after which a channel is isolated."""
    acceptances = SampleCount("acceptance_time")
    """Consistent samples in a row after which it is restored."""


@dataclass(frozen=True, eq=False, repr=False)
class DeadReckoningSettings(SampledSettings):
    """Consistency of poses with the motion measured with them."""

    window: float = 2.0  # s; over which poses are compared with their integrated motion
    gap: float = 0.3  # s; without a sample after which the integration starts anew
    median_time: float = 0.36  # s; at either end of the window whose median is compared
    smoothing_time: float = 0.2  # s; of samples whose median motion is integrated
    position_error: float = 0.03  # m; error of integrated velocities over the window
    attitude_error: float = 0.02  # rad; error of integrated body rates over the window
    sigmas: float = 5.0  # standard deviations of the medians' difference allowed beside that
    consistent_ratio: Share = 0.5  # test ratio of sources that count as evidence
    consecutive: int = 3  # inconsistent tests in a row that are needed of the payload unit
    misfit_limit: float = 25.0  # limit of squared innovations where poses and motions compete
    samples = SampleCount("median_time")
    """Samples whose median is compared."""
    smoothed = SampleCount("smoothing_time")
    """Samples whose median motion is integrated."""


@dataclass(frozen=True, eq=False, repr=False)
class NoiseAdaptationSettings(SampledSettings):
    """Adaptation of measurement and process noise to the innovations."""

    measurement_scale_max: float = 400.0  # largest scale of the measurement variances
    median_limit: float = 2.0  # median squared normalised innovation above which the scale grows
    growth: float = 1.3  # factor of the scale at each such update
    decay: Share = 0.97  # factor of the scale where that median is below 1
    process_levels: int = 3  # highest level of the process-noise scale of the forces
    process_step: float = 5.0  # factor of the forces' process noise from level to level
    correlation_memory: float = 0.4  # s; of the running mean of the correlation of innovations
    correlation_max: float = 3.0  # bound of the correlation of one update
    correlation_rise: float = 0.3  # mean correlation above which the level rises
    correlation_fall: float = 0.1  # mean correlation below which it falls
    dwell_time: float = 0.4  # s; between two changes of the level
    gap: float = 0.2  # s; between updates that are still consecutive
    persistent_cosine: Share = 0.5  # cosine between innovations that is no noise
    correlation_share = SampleShare("correlation_memory")
    """Share of an update in the mean correlation of innovations."""
    dwell = SampleCount("dwell_time")
    """Updates between two changes of the level."""


@dataclass(frozen=True, eq=False, repr=False)
class SetpointHistorySettings(SampledSettings):
    """Matching of commanded set-points with those the vehicles report to have flown."""

    rate: float = derived(20.0)
    """Rate of the set-points (Hz)."""
    loss_min: Share = 0.005  # least probability with which a set-point is lost on its link
    loss_memory: float = 1.0  # s; of the running mean of the loss
    loss_time_max: float = 1.0  # s; of lost set-points in a row that is noticed
    time_tolerance: float = 0.012  # s; about the time of effect in which either set-point may act
    period_min: float = 0.012  # s; least time between set-points
    punctuality: float = 0.005  # s; error of a reported time of effect: a step of the vehicle
    tilt_tolerance: float = 2e-4  # by which the tilts of one set-point differ
    thrust_tolerance: float = 2e-3  # N; by which the thrusts of one set-point differ
    neighbour_time: float = 0.15  # s; before and after a set-point whose others may act in its place
    loss_share = SampleShare("loss_memory")
    """Share of one set-point in the running mean of the loss."""
    losses_max = SampleCount("loss_time_max")
    """Set-points lost in a row that are noticed."""
    neighbours = SampleCount("neighbour_time")
    """Set-points before and after one that may act in its place."""


@dataclass(frozen=True, eq=False, repr=False)
class LiftOffSettings(SettingsTable):
    """Detection of lift-off, and the uncertainty of the mass by it."""

    speed: float = 0.05  # m/s; upward speed of what has lifted off, in the median of all sources
    sigmas: float = 6.0  # standard deviations of that median on the ground, if they are more
    steps: int = 2  # control steps in a row with such a speed
    age_max: float = 0.2  # s; of a velocity that is used
    mass: float = 0.06  # kg; standard deviation of the mass by thrust and momentum
    significance: float = 3.0  # of these, by which another mass than the expected one is taken


@dataclass(frozen=True, eq=False, repr=False)
class WindSettings(SettingsTable):
    """Memory, uncertainties and extent of the wind estimate."""

    memory: float = 10.0  # s; time constant with which the past is discounted
    speed_max: float = 8.0  # m/s; largest wind along each axis
    spacing: float = 0.5  # m/s; spacing of the grid of winds
    gust_force: float = 1.0  # N; force that a steady wind leaves unexplained, root mean square
    gust_time: float = 2.0  # s; correlation time of that force
    factor_sigma: float = 0.3  # standard deviation of the drag factor about 1
    factor_max: float = 2.0  # largest drag factor
    speed_sigma: float = 4.0  # m/s; standard deviation of the wind along each axis
    force_min: float = 0.4  # N; force below which there is no wind, root mean square over the memory
    explained_min: Share = 0.3  # share of the force that a wind must explain to be used
    explained_full: Share = 0.7  # share from which on it is used wholly

    def __post_init__(self) -> None:
        if self.explained_full <= self.explained_min:
            low, high = self.explained_min, self.explained_full
            raise ParameterError(f"explained_full ({high:g}) is not above explained_min ({low:g})")


@dataclass(frozen=True, eq=False, repr=False)
class InnovationMonitorSettings(SampledSettings):
    """Detection of bias and noise by the innovations of one sensor over about a second."""

    false_alarm: Share = 1e-10  # probability per sample of an alarm of a nominal sensor
    memory: float = 1.0  # s; of the running means
    rejections: int = 3  # rejections within the time below that are an alarm
    rejection_time: float = 1.0  # s; in which they are counted
    manoeuvre_factor: float = 2.5  # of these limits for UAV attitudes, modelled less exactly
    share = SampleShare("memory")
    """Share of one sample in the running means."""


@dataclass(frozen=True, eq=False, repr=False)
class GroundedLinksSettings(SettingsTable):
    """Links over a payload on the ground: initial uncertainties, noise densities per square root of a second."""

    tilt: float = 0.02  # initial uncertainty of the lateral parts of the link directions
    tilt_rate: float = 0.02  # 1/s; of their derivatives
    thrust_error: float = 0.02  # rad; of the error of the thrust directions
    direction: float = 0.01  # of the thrust directions
    link_acceleration: float = 0.1  # 1/s2/sqrt(s); gusts, and a payload that slides
    thrust_error_walk: float = 0.2  # rad/sqrt(s); an attitude that becomes wrong by 0.1 rad is to be found in 0.25 s
    error_time_constant: float = 0.5  # s; of what the UAVs have in common of these errors
    error_min: float = 0.04  # rad; three standard deviations of what is found of a UAV's own beside that of the air
    position_gap: float = 0.2  # s; without a position, after which a UAV has that, too
    reckoning_memory: float = 10.0  # s; over which positions are compared with the way by the velocities
    uav_jerk: float = 20.0  # 1/s3/sqrt(s); of thrust directions: some set-points are lost
    position_noise_min: float = 0.01  # m; least standard deviations of the measurements: the model's own errors
    velocity_noise_min: float = 0.02  # m/s
    attitude_noise_min: float = 0.003  # rad
    payload_share: Share = 0.1  # of an innovation of the payload's position that its estimate follows
    payload_step_max: float = 0.1  # m; of such an innovation: more is an error of its unit
    payload_speed_max: float = 0.5  # m/s; at which it slides
    innovation_max: float = 5.0  # standard deviations; larger innovations count as this: outliers do not move the state


@dataclass(frozen=True, eq=False, repr=False)
class AttitudeStepSettings(SettingsTable):
    """Steps of a UAV's attitude that its body rates do not explain."""

    false_alarm: Share = 1e-9  # probability per sample of a step of a nominal sensor
    turn_error: float = 0.25  # rad/s; of the turn by the rates of two samples, over the time between them
    noise_memory: float = 0.5  # s; over which the noise of the attitudes is followed
    persistent_share: Share = 0.5  # of a step that is left with the next sample: else it was that of one sample
    gap: float = 0.21  # s; between two samples that are compared: four are lost in a row
    drift_memory: float = 10.0  # s; over which a drift is summed up
    response_min: Share = 0.5  # share of the attitude loop's rate with which a vehicle turns against a step on board
    response_max: float = 2.0  # the same; a blow turns it faster


@dataclass(frozen=True, eq=False, repr=False)
class EstimatorSettings(SettingsTable):
    """All settings of the estimator, by part."""

    gate_probability: Share = 1.0 - 1e-6  # share of nominal measurements accepted
    history: float = 1.0  # s; by which a measurement may be late and is still used
    simultaneous: float = 0.002  # s; within which measurements are of one moment
    # share of the payload's mass by which the model's may be wrong: the links' frequency is then wrong by half of it
    model_mass_error: Share = 0.25
    model_mass_time: float = 0.3  # s; for which it must be
    model_mass_settled: Share = 0.05  # the same of a mass that was taken, within which it stays
    model_mass_settling: float = 1.0  # s; for which it must be beyond: twice the time constant of the learnt load
    payload_timeout: float = 0.3  # s; without the payload unit until a payload on ground is held
    process: ProcessNoiseSettings = field(default_factory=ProcessNoiseSettings)
    initial: InitialCovarianceSettings = field(default_factory=InitialCovarianceSettings)
    reset: CovarianceResetSettings = field(default_factory=CovarianceResetSettings)
    measurement: MeasurementModelSettings = field(default_factory=MeasurementModelSettings)
    stuck_sensor: StuckSensorSettings = field(default_factory=StuckSensorSettings)
    isolation: ChannelIsolationSettings = field(default_factory=ChannelIsolationSettings)
    dead_reckoning: DeadReckoningSettings = field(default_factory=DeadReckoningSettings)
    adaptation: NoiseAdaptationSettings = field(default_factory=NoiseAdaptationSettings)
    attitude_steps: AttitudeStepSettings = field(default_factory=AttitudeStepSettings)
    setpoints: SetpointHistorySettings = field(default_factory=SetpointHistorySettings)
    grounded_links: GroundedLinksSettings = field(default_factory=GroundedLinksSettings)

    def at_rates(self, telemetry: float, setpoints: float) -> Self:
        """Return the settings at the rates (Hz) of telemetry and set-points."""
        return replace(
            self,
            reset=replace(self.reset, rate=telemetry),
            isolation=replace(self.isolation, rate=telemetry),
            dead_reckoning=replace(self.dead_reckoning, rate=telemetry),
            adaptation=replace(self.adaptation, rate=telemetry),
            setpoints=replace(self.setpoints, rate=setpoints),
        )
