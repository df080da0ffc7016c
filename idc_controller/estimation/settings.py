"""Settings of the estimator: noise densities, tests, isolation, adaptation and memory."""

from dataclasses import dataclass, field, replace
from typing import Self

from idc_controller.errors import ParameterError
from idc_controller.settings import SampleCount, SampledSettings, SampleShare, SettingsTable, derived, setting


@dataclass(frozen=True, eq=False, repr=False)
class ProcessNoiseSettings(SettingsTable):
    """Densities of the white noise that drives what the linear model leaves out, per square root of a second."""

    payload_acceleration: float = setting(0.003, "m/s2/sqrt(s)", "noise of the payload's acceleration", ge=0.0)
    payload_angular_acceleration: float = setting(0.003, "rad/s2/sqrt(s)", "noise of its angular acceleration", ge=0.0)
    link_acceleration: float = setting(0.0015, "1/s2/sqrt(s)", "noise of the acceleration of link directions", ge=0.0)
    uav_jerk: float = setting(0.85, "1/s3/sqrt(s)", "noise of the third derivative of a UAV's thrust direction", ge=0.0)
    thrust: float = setting(0.012, "N/s/sqrt(s)", "noise of the derivative of a UAV's thrust", ge=0.0)
    force: float = setting(0.05, "N/sqrt(s)", "random walk of the disturbance force on the payload", ge=0.0)
    uav_force: float = setting(0.01, "N/sqrt(s)", "random walk of the disturbance force common to the UAVs", ge=0.0)
    per_vehicle_force: float = setting(0.01, "N", "change of each UAV's disturbance force between samples", ge=0.0)
    mass: float = setting(0.005, "kg/sqrt(s)", "random walk of the payload's mass", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class InitialCovarianceSettings(SettingsTable):
    """Standard deviations of the state of a team that stands on the ground."""

    position: float = setting(0.05, "m", "initial uncertainty of the payload's position", gt=0.0)
    velocity: float = setting(0.02, "m/s", "initial uncertainty of the payload's velocity", gt=0.0)
    attitude: float = setting(0.02, "rad", "initial uncertainty of the payload's attitude", gt=0.0)
    rates: float = setting(0.02, "rad/s", "initial uncertainty of the payload's body rates", gt=0.0)
    link: float = setting(0.02, "", "initial uncertainty of the lateral parts of the link directions", gt=0.0)
    link_rate: float = setting(0.02, "1/s", "initial uncertainty of their derivatives", gt=0.0)
    thrust_direction: float = setting(0.03, "", "initial uncertainty of the UAVs' thrust directions", gt=0.0)
    thrust_direction_rate: float = setting(0.1, "1/s", "initial uncertainty of their first derivatives", gt=0.0)
    thrust_direction_acceleration: float = setting(0.3, "1/s2", "initial uncertainty of their second ones", gt=0.0)
    thrust: float = setting(0.5, "N", "initial uncertainty of a UAV's thrust", gt=0.0)
    mass: float = setting(0.2, "kg", "initial uncertainty of the payload's mass about its nominal one", ge=0.0)
    force: float = setting(0.3, "N", "initial uncertainty of the disturbance force on the payload", ge=0.0)
    uav_force: float = setting(0.05, "N", "initial uncertainty of the disturbance force common to the UAVs", ge=0.0)
    per_vehicle_force: float = setting(0.05, "N", "initial uncertainty of each UAV's own disturbance force", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class CovarianceResetSettings(SampledSettings):
    """Standard deviations added to a prediction that most measurements contradict: what a gust or a blow changes."""

    velocity: float = setting(0.1, "m/s", "added to the payload's velocity", ge=0.0)
    rates: float = setting(0.1, "rad/s", "added to the payload's body rates", ge=0.0)
    link_rate: float = setting(0.03, "1/s", "added to the derivatives of the link directions", ge=0.0)
    force: float = setting(3.0, "N", "raised uncertainty of the disturbance force on the payload", ge=0.0)
    payload_time: float = setting(0.12, "s", "of rejections of the payload unit until the prediction is reset", gt=0.0)
    payload_rejections = SampleCount("payload_time")
    """Rejections of the payload unit in a row after which the prediction is reset rather than the unit."""


@dataclass(frozen=True, eq=False, repr=False)
class MeasurementModelSettings(SettingsTable):
    """Least standard deviations of measurements: the linear model's own errors, whatever the sensor's noise is."""

    position_noise_min: float = setting(2e-3, "m", "least noise assumed of a position", gt=0.0)
    velocity_noise_min: float = setting(4e-3, "m/s", "least noise assumed of a velocity", gt=0.0)
    attitude_noise_min: float = setting(2e-4, "rad", "least noise assumed of an attitude", gt=0.0)
    rates_noise_min: float = setting(1e-3, "rad/s", "least noise assumed of body rates", gt=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class StuckSensorSettings(SettingsTable):
    """Detection of repeated values, which are no measurements."""

    repeats: int = setting(2, "", "repetitions to the digit after which a channel is stuck", ge=1)
    relay_interval: float = setting(0.02, "s", "by which the stamps of relayed copies of one sample differ", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class ChannelIsolationSettings(SampledSettings):
    """Isolation and restoration of a vehicle's channels."""

    rejection_time: float = setting(0.48, "s", "of rejections less acceptances until a channel is isolated", gt=0.0)
    acceptance_time: float = setting(1.0, "s", "of consistent samples in a row until it is restored", gt=0.0)
    restoring_probability: float = setting(0.999, "", "share of nominal samples that are consistent", gt=0.0, lt=1.0)
    unusable_time: float = setting(0.5, "s", "for which a missing, stuck or rejected pose is unusable", ge=0.0)
    rejections = SampleCount("rejection_time")
    """Rejections less acceptances after which a channel is isolated."""
    acceptances = SampleCount("acceptance_time")
    """Consistent samples in a row after which it is restored."""


@dataclass(frozen=True, eq=False, repr=False)
class DeadReckoningSettings(SampledSettings):
    """Consistency of poses with the motion measured with them."""

    window: float = setting(2.0, "s", "over which poses are compared with their integrated motion", gt=0.0)
    gap: float = setting(0.3, "s", "without a sample after which the integration starts anew", gt=0.0)
    median_time: float = setting(0.36, "s", "at either end of the window whose median is compared", gt=0.0)
    smoothing_time: float = setting(0.2, "s", "of samples whose median motion is integrated", gt=0.0)
    position_error: float = setting(0.03, "m", "error of integrated velocities over the window", gt=0.0)
    attitude_error: float = setting(0.02, "rad", "error of integrated body rates over the window", gt=0.0)
    sigmas: float = setting(5.0, "", "standard deviations of the medians' difference allowed beside that", gt=0.0)
    consistent_ratio: float = setting(0.5, "", "test ratio of sources that count as evidence", gt=0.0, lt=1.0)
    consecutive: int = setting(3, "", "inconsistent tests in a row that are needed of the payload unit", ge=1)
    misfit_limit: float = setting(25.0, "", "limit of squared innovations where poses and motions compete", gt=0.0)
    samples = SampleCount("median_time")
    """Samples whose median is compared."""
    smoothed = SampleCount("smoothing_time")
    """Samples whose median motion is integrated."""


@dataclass(frozen=True, eq=False, repr=False)
class NoiseAdaptationSettings(SampledSettings):
    """Adaptation of measurement and process noise to the innovations."""

    measurement_scale_max: float = setting(400.0, "", "largest scale of the measurement variances", ge=1.0)
    median_limit: float = setting(2.0, "", "median squared normalised innovation above which the scale grows", gt=1.0)
    growth: float = setting(1.3, "", "factor of the scale at each such update", gt=1.0)
    decay: float = setting(0.97, "", "factor of the scale where that median is below 1", gt=0.0, lt=1.0)
    process_levels: int = setting(3, "", "highest level of the process-noise scale of the forces", ge=0)
    process_step: float = setting(5.0, "", "factor of the forces' process noise from level to level", gt=1.0)
    correlation_memory: float = setting(0.4, "s", "of the running mean of the correlation of innovations", gt=0.0)
    correlation_max: float = setting(3.0, "", "bound of the correlation of one update", gt=0.0)
    correlation_rise: float = setting(0.3, "", "mean correlation above which the level rises", gt=0.0)
    correlation_fall: float = setting(0.1, "", "mean correlation below which it falls", gt=0.0)
    dwell_time: float = setting(0.4, "s", "between two changes of the level", gt=0.0)
    gap: float = setting(0.2, "s", "between updates that are still consecutive", gt=0.0)
    persistent_cosine: float = setting(0.5, "", "cosine between innovations that is no noise", gt=-1.0, lt=1.0)
    correlation_share = SampleShare("correlation_memory")
    """Share of an update in the mean correlation of innovations."""
    dwell = SampleCount("dwell_time")
    """Updates between two changes of the level."""


@dataclass(frozen=True, eq=False, repr=False)
class SetpointHistorySettings(SampledSettings):
    """Matching of commanded set-points with those the vehicles report to have flown."""

    rate: float = derived(20.0)
    """Rate of the set-points (Hz)."""
    loss_min: float = setting(0.005, "", "least probability with which a set-point is lost on its link", gt=0.0, le=1.0)
    loss_memory: float = setting(1.0, "s", "of the running mean of the loss", gt=0.0)
    loss_time_max: float = setting(1.0, "s", "of lost set-points in a row that is noticed", gt=0.0)
    time_tolerance: float = setting(0.012, "s", "about the time of effect in which either set-point may act", ge=0.0)
    period_min: float = setting(0.012, "s", "least time between set-points", gt=0.0)
    punctuality: float = setting(0.005, "s", "error of a reported time of effect: a step of the vehicle", ge=0.0)
    tilt_tolerance: float = setting(2e-4, "", "by which the tilts of one set-point differ", ge=0.0)
    thrust_tolerance: float = setting(2e-3, "N", "by which the thrusts of one set-point differ", ge=0.0)
    neighbour_time: float = setting(0.15, "s", "before and after a set-point whose others may act in its place", gt=0.0)
    loss_share = SampleShare("loss_memory")
    """Share of one set-point in the running mean of the loss."""
    losses_max = SampleCount("loss_time_max")
    """Set-points lost in a row that are noticed."""
    neighbours = SampleCount("neighbour_time")
    """Set-points before and after one that may act in its place."""


@dataclass(frozen=True, eq=False, repr=False)
class WindSettings(SettingsTable):
    """Memory, uncertainties and extent of the wind estimate."""

    memory: float = setting(10.0, "s", "time constant with which the past is discounted", gt=0.0)
    speed_max: float = setting(8.0, "m/s", "largest wind along each axis", gt=0.0)
    spacing: float = setting(0.5, "m/s", "spacing of the grid of winds", gt=0.0)
    gust_force: float = setting(1.0, "N", "force that a steady wind leaves unexplained, root mean square", gt=0.0)
    gust_time: float = setting(2.0, "s", "correlation time of that force", gt=0.0)
    factor_sigma: float = setting(0.3, "", "standard deviation of the drag factor about 1", gt=0.0)
    factor_max: float = setting(2.0, "", "largest drag factor", gt=0.0)
    speed_sigma: float = setting(4.0, "m/s", "standard deviation of the wind along each axis", gt=0.0)
    force_min: float = setting(0.4, "N", "force below which there is no wind, root mean square over the memory", gt=0.0)
    explained_min: float = setting(0.3, "", "share of the force that a wind must explain to be used", ge=0.0, le=1.0)
    explained_full: float = setting(0.7, "", "share from which on it is used wholly", gt=0.0, le=1.0)

    def __post_init__(self) -> None:
        if self.explained_full <= self.explained_min:
            low, high = self.explained_min, self.explained_full
            raise ParameterError(f"explained_full ({high:g}) is not above explained_min ({low:g})")


@dataclass(frozen=True, eq=False, repr=False)
class InnovationMonitorSettings(SampledSettings):
    """Detection of bias and noise by the innovations of one sensor over about a second."""

    false_alarm: float = setting(1e-10, "", "probability per sample of an alarm of a nominal sensor", gt=0.0, lt=1.0)
    memory: float = setting(1.0, "s", "of the running means", gt=0.0)
    rejections: int = setting(3, "", "rejections within the time below that are an alarm", ge=1)
    rejection_time: float = setting(1.0, "s", "in which they are counted", gt=0.0)
    manoeuvre_factor: float = setting(2.5, "", "of these limits for UAV attitudes, modelled less exactly", ge=1.0)
    share = SampleShare("memory")
    """Share of one sample in the running means."""


@dataclass(frozen=True, eq=False, repr=False)
class EstimatorSettings(SettingsTable):
    """All settings of the estimator, by part."""

    gate_probability: float = setting(1.0 - 1e-6, "", "share of nominal measurements accepted", gt=0.0, lt=1.0)
    history: float = setting(1.0, "s", "by which a measurement may be late and is still used", gt=0.0)
    simultaneous: float = setting(0.002, "s", "within which measurements are of one moment", ge=0.0)
    payload_timeout: float = setting(0.3, "s", "without the payload unit until a payload on ground is held", gt=0.0)
    process: ProcessNoiseSettings = field(default_factory=ProcessNoiseSettings)
    initial: InitialCovarianceSettings = field(default_factory=InitialCovarianceSettings)
    reset: CovarianceResetSettings = field(default_factory=CovarianceResetSettings)
    measurement: MeasurementModelSettings = field(default_factory=MeasurementModelSettings)
    stuck_sensor: StuckSensorSettings = field(default_factory=StuckSensorSettings)
    isolation: ChannelIsolationSettings = field(default_factory=ChannelIsolationSettings)
    dead_reckoning: DeadReckoningSettings = field(default_factory=DeadReckoningSettings)
    adaptation: NoiseAdaptationSettings = field(default_factory=NoiseAdaptationSettings)
    setpoints: SetpointHistorySettings = field(default_factory=SetpointHistorySettings)

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
