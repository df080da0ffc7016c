"""Settings of perception: scans, association, tracks and their retention, map check, surfaces, motion models."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

from idc_controller.errors import ParameterError
from idc_controller.settings import SampleCount, SampledSettings, SettingsTable, derived, setting


@dataclass(frozen=True, eq=False, repr=False)
class ScanSettings(SampledSettings):
    """Placing of detections in the world, and validity of a range sensor's telemetry."""

    pose_gap: float = setting(0.1, "s", "largest time between a scan and the pose that places it", gt=0.0)
    pose_wait: float = setting(0.3, "s", "for which a scan waits for a measured pose", ge=0.0)
    assembly: float = setting(0.1, "s", "for which a scan waits for messages that are missing", ge=0.0)
    pose_memory: float = setting(1.2, "s", "for which poses are kept", gt=0.0)
    simultaneous: float = setting(0.02, "s", "within which scans of several vehicles are one frame", ge=0.0)
    estimated_attitude_sigma: float = setting(0.03, "rad", "standard deviation of estimated attitudes", ge=0.0)
    cut_sigmas: float = setting(4.0, "", "standard deviations from the end of the range that cut a surface", ge=0.0)
    range_factor: float = setting(2.0, "", "of the sensor's range, beyond which a detection is impossible", ge=1.0)
    points_max: int = setting(2000, "", "points of a vehicle that wait at a time", ge=1)
    invalid_after: float = setting(0.5, "s", "of invalid detections until a range sensor counts as lost", ge=0.0)
    recovery: float = setting(1.0, "s", "after the last of them for which it still does", ge=0.0)
    silent_after: float = setting(1.0, "s", "of poses of a vehicle without a scan until its sensor is silent", gt=0.0)
    ray_offset_min: float = setting(
        0.05, "m", "offset of returns from the sensor's rays from which on they are displaced", gt=0.0
    )
    ray_offset_false_alarm: float = setting(
        1e-6, "", "probability that the scatter of returns about the rays looks like an offset", gt=0.0, lt=1.0
    )
    ray_offset_duration: float = setting(0.4, "s", "for which an offset from the rays must last", ge=0.0)
    poses = SampleCount("pose_memory")
    """Poses of a vehicle that are kept."""
    silent = SampleCount("silent_after")
    """Poses of a vehicle without a scan from which on its sensor is silent."""


@dataclass(frozen=True, eq=False, repr=False)
class AssociationSettings(SettingsTable):
    """Gating distances between clusters of points and surfaces."""

    map_gate: float = setting(0.25, "m", "mean distance of a cluster from a standing obstacle of the map", gt=0.0)
    track_gate: float = setting(0.4, "m", "mean distance from a track, beside the track's own uncertainty", gt=0.0)
    undetected_gate: float = setting(3.0, "m", "mean distance from a moving map obstacle not detected yet", gt=0.0)
    group_gate: float = setting(0.5, "m", "mean distance between clusters of vehicles that begin one track", gt=0.0)
    remembered_gate: float = setting(1.2, "m", "mean distance from a map obstacle that is seen offset", gt=0.0)
    wall_extension: float = setting(4.0, "m", "by which a wall may be larger than detected so far", ge=0.0)
    merge_gate: float = setting(0.25, "m", "mean distance of a track's points from another that merges them", gt=0.0)
    merge_frames: int = setting(3, "", "frames in a row for which that must hold", ge=1)


@dataclass(frozen=True, eq=False, repr=False)
class RetentionSettings(SettingsTable):
    """Confirmation, coasting and deletion of tracks."""

    confirmations: int = setting(2, "", "clusters after which a track is confirmed", ge=1)
    tentative_time: float = setting(0.5, "s", "without a detection after which a tentative track is deleted", gt=0.0)
    coasting_after: float = setting(0.3, "s", "without a detection after which a static track coasts at rest", gt=0.0)
    delete_after: float = setting(1.0, "s", "without a detection in the field of view until deletion", gt=0.0)
    forget_after: float = setting(2.0, "s", "without a detection out of view until a moving track is deleted", gt=0.0)
    restorable: float = setting(3.0, "s", "after deletion in which lost sensing restores a track", ge=0.0)
    in_view_share: float = setting(0.8, "", "share of the range within which detection is certain", gt=0.0, le=1.0)
    link_timeout: float = setting(0.3, "s", "age of a position up to which a vehicle's field of view counts", gt=0.0)
    visited_memory: float = setting(
        10.0, "s", "for which the places are kept that an unpredictable track visited", gt=0.0
    )
    visited_before: float = setting(1.0, "s", "ago, from which on a place counts as visited before", ge=0.0)
    undetected_growth: float = setting(0.5, "m", "growth of a moving map obstacle not detected yet", ge=0.0)


@dataclass(frozen=True, eq=False, repr=False)
class MapCheckSettings(SettingsTable):
    """Detection of an offset of the obstacles from their places on the map."""

    offset_min: float = setting(0.2, "m", "offset from which on detections contradict the map", gt=0.0)
    false_alarm: float = setting(
        1e-6, "", "probability per scan that noise alone is an offset, of all obstacles and vehicles", gt=0.0, lt=1.0
    )
    duration: float = setting(0.4, "s", "for which it must last: the time until a wrong pose is isolated", ge=0.0)
    agreement_sigmas: float = setting(1.25, "", "mean distance of a scan that agrees, in standard deviations", gt=0.0)
    agreements: int = setting(5, "", "such scans before an offset of the obstacle can be detected", ge=1)
    walk: float = setting(0.05, "m/sqrt(s)", "random walk of the offset", ge=0.0)
    initial_sigma: float = setting(0.5, "m", "initial uncertainty of the offset", gt=0.0)
    smoothing: float = setting(0.3, "", "share of one scan in the mean scatter of points", gt=0.0, le=1.0)


@dataclass(frozen=True, eq=False, repr=False)
class ImmSettings(SettingsTable):
    """Motion models of the interacting multiple model (IMM) filter, and their process noise."""

    static_walk: float = setting(0.01, "m/sqrt(s)", "static model: random walk of the position", ge=0.0)
    velocity_walk: float = setting(0.15, "m/s/sqrt(s)", "constant-velocity model: random walk of the velocity", ge=0.0)
    singer_accelerations: tuple[float, ...] = setting((1.0, 4.0), "m/s2", "Singer models: accelerations", gt=0.0)
    singer_times: tuple[float, ...] = setting((1.0, 0.5), "s", "Singer models: their correlation times", gt=0.0)
    frequencies: tuple[float, ...] = setting(
        (0.5, 0.7, 1.0, 1.4, 2.0, 2.8), "rad/s", "harmonic models: angular frequencies", gt=0.0
    )
    harmonic_walk: float = setting(0.1, "m/s2/sqrt(s)", "harmonic models: acceleration's walk at 1 rad/s", ge=0.0)
    initial_velocity: float = setting(1.5, "m/s", "initial standard deviation of the velocity", gt=0.0)
    initial_acceleration: float = setting(1.5, "m/s2", "initial standard deviation of the acceleration", gt=0.0)
    transition_rate: float = setting(0.1, "1/s", "share of a model's weight that moves to the others", ge=0.0)

    def __post_init__(self) -> None:
        sigmas, times = len(self.singer_accelerations), len(self.singer_times)
        if sigmas != times:
            raise ParameterError(f"singer_accelerations has {sigmas} values and singer_times {times}: one each a model")


@dataclass(frozen=True, eq=False, repr=False)
class ManoeuvreSettings(SampledSettings):
    """Manoeuvres that no motion model contains, and the growth of predictions for them."""

    rate: float = derived(10.0)
    """Rate of the scans (Hz)."""
    mismatch_begin: float = setting(0.9, "", "mean squared innovation (usually 0.5) from which on models fail", gt=0.0)
    mismatch_full: float = setting(1.5, "", "from which on they mismatch wholly", gt=0.0)
    mismatch_acceleration: float = setting(2.0, "m/s2", "standard deviation of the acceleration then", ge=0.0)
    innovation_max: float = setting(10.0, "", "bound of one squared innovation", gt=0.0)
    innovation_share: float = setting(0.15, "", "share of one innovation in their mean", gt=0.0, le=1.0)
    memory: float = setting(8.0, "s", "time constant with which mismatch and prediction error decay", gt=0.0)
    horizon: float = setting(1.0, "s", "after which predictions are compared with the track", gt=0.0)
    usual_error: float = setting(0.15, "m", "error of a good prediction over that time, at least", ge=0.0)
    settling: float = setting(3.0, "s", "after the first detection until predictions are compared", ge=0.0)
    growth_max: float = setting(0.5, "m", "largest growth of a body while predictions are right", ge=0.0)
    growth_per_error: float = setting(1.5, "", "by which that rises with the prediction error", ge=0.0)
    growth_limit: float = setting(1.5, "m", "up to which it rises: an obstacle may come faster than the team", ge=0.0)

    @property
    def frame(self) -> float:
        """Time about a scan within which a prediction is due: half of that between scans (s)."""
        return 0.5 / self.rate

    def __post_init__(self) -> None:
        if self.mismatch_full <= self.mismatch_begin:
            raise ParameterError(
                f"mismatch_full {self.mismatch_full:g} is not above mismatch_begin {self.mismatch_begin:g}"
            )


@dataclass(frozen=True, eq=False, repr=False)
class SurfaceSettings(SettingsTable):
    """Fits of spheres, poles, walls and known shapes to the points of one frame."""

    model_sigma: float = setting(0.015, "m", "standard deviation of a real surface about its shape", ge=0.0)
    sideways_sigma: float = setting(
        0.1, "m", "movement expected on axes on which no point shows it, and of a wall along itself by its ends", gt=0.0
    )
    unseen_sigma: float = setting(0.5, "m", "of the place of a wall along itself while its ends are not seen", gt=0.0)
    scatter_loss: float = setting(18.0, "", "factor of scatter in the uncertainty of a centre: by trial", ge=0.0)
    radius: float = setting(0.6, "m", "of a sphere or pole before anything is detected: rather too large", gt=0.0)
    radius_sigma: float = setting(0.35, "m", "its standard deviation", gt=0.0)
    radius_sigma_min: float = setting(0.015, "m", "least standard deviation of a radius", gt=0.0)
    radius_walk: float = setting(0.003, "m", "random walk of a radius from frame to frame", ge=0.0)
    sphere_radius_min: float = setting(0.1, "m", "smallest sphere", gt=0.0)
    pole_radius_min: float = setting(0.04, "m", "smallest radius of a pole", gt=0.0)
    radius_max: float = setting(1.6, "m", "largest radius of a sphere or pole", gt=0.0)
    centre_sigma: float = setting(2.0, "m", "uncertainty of the first guess of a centre", gt=0.0)
    pole_end_depth: float = setting(0.1, "m", "within a pole's side from which on a point lies on its end", ge=0.0)
    pole_end_share: float = setting(0.2, "", "and share of the radius beside that", ge=0.0)
    pole_extension: float = setting(3.0, "m", "of a pole above points at the end of the range", ge=0.0)
    side_extension: float = setting(1.0, "m", "of a wall to the side of them", ge=0.0)
    top_extension: float = setting(2.0, "m", "of a wall above and below them", ge=0.0)
    thickness: float = setting(0.4, "m", "of a wall while only its front is detected", gt=0.0)
    depth_observed: float = setting(0.12, "m", "behind the front from which on points show the thickness", gt=0.0)
    yaw_sigma: float = setting(0.1, "rad", "initial uncertainty of a wall's heading", gt=0.0)
    yaw_walk: float = setting(0.001, "rad", "its random walk from frame to frame", ge=0.0)
    size_sigma_max: float = setting(0.3, "m", "largest uncertainty of a wall's ends from its heading", ge=0.0)
    end_jump: float = setting(0.3, "m", "from which on an end is somewhere else rather than measured anew", gt=0.0)
    end_smoothing: float = setting(0.2, "", "share of one frame in the place of an end", gt=0.0, le=1.0)
    end_retreat: float = setting(0.15, "", "the same where the surface seems much shorter", gt=0.0, le=1.0)


@dataclass(frozen=True, eq=False, repr=False)
class ObstacleFilterSettings(SettingsTable):
    """Shape and motion of one track."""

    outside_share: float = setting(
        0.01,
        "",
        "probability that the true body reaches out of the predicted one, where its growth has no limit",
        gt=0.0,
        lt=0.5,
    )
    static_speed: float = setting(0.1, "m/s", "speed below which a track is static", gt=0.0)
    static_weight: float = setting(0.5, "", "weight of the static model above which it is", gt=0.0, lt=1.0)
    mover_speed_max: float = setting(5.0, "m/s", "speed above which a track is no obstacle that moves", gt=0.0)
    mover_face_max: float = setting(
        1.6, "m", "edges of a flat face of which both are longer: that is a wall, and does not move", gt=0.0
    )
    late_speed: float = setting(0.5, "m/s", "uncertainty of the speed by which late frames are moved", ge=0.0)
    pole_complexity: float = setting(0.4, "", "by which a pole must fit better than a sphere", ge=0.0)
    wall_complexity: float = setting(0.8, "", "by which a wall must fit better than a sphere", ge=0.0)
    hysteresis: float = setting(1.0, "", "by which another shape must fit better than the one so far", ge=0.0)
    smoothing: float = setting(0.3, "", "share of one frame in the mean score and scatter", gt=0.0, le=1.0)
    points_min: int = setting(5, "", "points of a frame from which shape and scatter are learnt", ge=1)
    every_frame_until: int = setting(6, "", "frames in which all shapes are tried", ge=0)
    every_frames: int = setting(20, "", "frames after which they are tried again", ge=1)
    retry_score: float = setting(2.5, "", "score from which on they are tried at once (about 1 is right)", gt=1.0)
    scatter_max: float = setting(0.5, "m", "largest standard deviation of the points' scatter", gt=0.0)
    outermost_sigmas: float = setting(1.5, "", "standard deviations by which noise alone puts points outside", ge=0.0)
    seen_memory: float = setting(2.0, "s", "for which points are remembered that the body must hold", ge=0.0)
    false_share: float = setting(0.01, "", "share of them that are not of this body", ge=0.0, lt=1.0)
    surfaces: SurfaceSettings = field(default_factory=SurfaceSettings)
    motion: ImmSettings = field(default_factory=ImmSettings)
    manoeuvre: ManoeuvreSettings = field(default_factory=ManoeuvreSettings)


@dataclass(frozen=True, eq=False, repr=False)
class StandingMapSettings(SettingsTable):
    """Standing map: voxels, evidence of free and occupied space, and the bodies that cover it."""

    voxel: float = setting(
        0.25, "m", "edge of a voxel: three standard deviations of a return at most of the range", gt=0.0
    )
    missed_share: float = derived(0.02)
    """Share of the range sensors' rays that return nothing though they hit."""
    false_share: float = setting(0.01, "", "share of returns where nothing is", gt=0.0, lt=1.0)
    false_free: float = setting(1e-3, "", "probability that what fills a voxel is seen free", gt=0.0, lt=1.0)
    false_removal: float = setting(
        1e-5, "", "probability that what stands is freed by one run of scans that pass it", gt=0.0, lt=1.0
    )
    false_alarm: float = setting(1e-3, "", "probability that noise leaves a return unexplained", gt=0.0, lt=1.0)
    uncovered: float = setting(1e-3, "", "probability that a surface lies beyond what covers it", gt=0.0, lt=1.0)
    prior_hits: float = setting(4.0, "", "scans that hit what stands at a ray's place, before any was counted", gt=0.0)
    prior_passes: float = setting(1.0, "", "scans that pass it by the poses' noise, before any was counted", gt=0.0)
    hit_share_min: float = setting(
        0.25, "", "least share of the scans through its place that hit what stands", gt=0.0, lt=1.0
    )
    hit_share_along: float = setting(0.1, "", "the same of scans along its surface", gt=0.0, lt=1.0)
    memory: float = setting(64.0, "", "scans whose hits and passes are remembered", ge=2.0)
    sigmas_beyond: float = setting(3.0, "", "standard deviations by which a ray must end beyond what it passes", gt=0.0)
    incidence_min: float = setting(
        0.5, "", "least cosine between a ray that passes through points and their surface's normal", ge=0.0, lt=1.0
    )
    standing_speed: float = setting(0.15, "m/s", "speed of points below which they count as standing", gt=0.0)
    tolerance: float = setting(0.03, "m", "to which surfaces are covered without being computed anew", gt=0.0)
    exploring_stride: int = setting(
        4, "", "of the rays without return, one of so many is followed where nothing stands in its direction", ge=1
    )
    bridged_gap: float = setting(1.0, "m", "between points that one body covers without what lies between", gt=0.0)
    smallest_body: float = setting(
        1.0,
        "m",
        "edge of the smallest unknown obstacle before which the formation must be able to stop: space is seen free in "
        "cells of that edge, by so many rays that all of them miss it with the probability false_free",
        gt=0.0,
    )

    @cached_property
    def free_passes(self) -> int:
        """Rays through a voxel from which on it counts as seen free: each of them may have been missed."""
        if self.missed_share == 0.0:
            return 1
        return max(math.ceil(math.log(self.false_free) / math.log(self.missed_share)), 1)

    @cached_property
    def sight_width(self) -> int:
        """Voxels along the edge of the cells in which space is seen free: a body of the smallest size fills one."""
        return max(width for width in (1, 2, 4, 8) if width == 1 or width * self.voxel <= self.smallest_body)

    @cached_property
    def sight_rays(self) -> int:
        """Followed rays through a cell from which on it was seen free.

        Each stands for the rays that are not followed; a body as large as the cell, anywhere about it, is met by about
        as many as pass the cell (Poisson).
        """
        rays = -math.log(self.false_free) / (self.exploring_stride * (1.0 - self.missed_share))
        return max(math.ceil(rays), 1)

    @cached_property
    def evidence_of_hit(self) -> float:
        """Evidence of a scan's hit that something stands (nats)."""
        return math.log(self.prior_hits / (self.prior_hits + self.prior_passes) / self.false_share)

    @property
    def evidence_of_pass(self) -> tuple[float, float]:
        """Least evidence of a scan through something, and along its surface, that it is gone (nats)."""
        return -math.log1p(-self.hit_share_min), -math.log1p(-self.hit_share_along)

    @property
    def evidence_max(self) -> float:
        """Evidence of a run of passes that frees what was hit often (nats)."""
        return -math.log(self.false_removal)

    @property
    def settling_time(self) -> float:
        """Time for which points must stay in one voxel that was seen free to count as standing (s)."""
        return self.voxel / self.standing_speed


@dataclass(frozen=True, eq=False, repr=False)
class PerceptionSettings(SettingsTable):
    """All settings of the obstacle map, by part."""

    scans: ScanSettings = field(default_factory=ScanSettings)
    association: AssociationSettings = field(default_factory=AssociationSettings)
    retention: RetentionSettings = field(default_factory=RetentionSettings)
    map_check: MapCheckSettings = field(default_factory=MapCheckSettings)
    tracking: ObstacleFilterSettings = field(default_factory=ObstacleFilterSettings)
    standing_map: StandingMapSettings = field(default_factory=StandingMapSettings)

    def of_sensors(self, telemetry: float, scans: float, missed_share: float) -> Self:
        """Return the settings at the rates (Hz) of telemetry and of range sensors that miss a share of the hits."""
        return replace(
            self,
            scans=replace(self.scans, rate=telemetry),
            tracking=replace(self.tracking, manoeuvre=replace(self.tracking.manoeuvre, rate=scans)),
            standing_map=replace(self.standing_map, missed_share=missed_share),
        )
