"""Settings of perception: scans, association, tracks and their retention, map check, surfaces, motion models."""

import math
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Self

from idc_controller.errors import ParameterError
from idc_controller.settings import SampleCount, SampledSettings, SettingsTable, Share, derived, setting


@dataclass(frozen=True, eq=False, repr=False)
class ScanSettings(SampledSettings):
    """Placing of detections in the world, and validity of a range sensor's telemetry."""

    pose_gap: float = 0.1  # s; largest time between a scan and the pose that places it
    pose_wait: float = 0.3  # s; for which a scan waits for a measured pose
    assembly: float = 0.1  # s; for which a scan waits for messages that are missing
    pose_memory: float = 1.2  # s; for which poses are kept
    simultaneous: float = 0.02  # s; within which scans of several vehicles are one frame
    estimated_attitude_sigma: float = 0.03  # rad; standard deviation of estimated attitudes
    cut_sigmas: float = 4.0  # standard deviations from the end of the range that cut a surface
    range_factor: float = 2.0  # of the sensor's range, beyond which a detection is impossible
    points_max: int = 2000  # points of a vehicle that wait at a time
    invalid_after: float = 0.5  # s; of invalid detections until a range sensor counts as lost
    recovery: float = 1.0  # s; after the last of them for which it still does
    silent_after: float = 1.0  # s; of poses of a vehicle without a scan until its sensor is silent
    ray_offset_min: float = 0.05  # m; offset of returns from the sensor's rays from which on they are displaced
    ray_offset_false_alarm: Share = 1e-6  # probability that the scatter of returns about the rays looks like an offset
    ray_offset_duration: float = 0.4  # s; for which an offset from the rays must last
    poses = SampleCount("pose_memory")
    """Poses of a vehicle that are kept."""
    silent = SampleCount("silent_after")
    """Poses of a vehicle without a scan from which on its sensor is silent."""


@dataclass(frozen=True, eq=False, repr=False)
class AssociationSettings(SettingsTable):
    """Gating distances between clusters of points and surfaces."""

    map_gate: float = 0.25  # m; mean distance of a cluster from a standing obstacle of the map
    track_gate: float = 0.4  # m; mean distance from a track, beside the track's own uncertainty
    undetected_gate: float = 3.0  # m; mean distance from a moving map obstacle not detected yet
    group_gate: float = 0.5  # m; mean distance between clusters of vehicles that begin one track
    remembered_gate: float = 1.2  # m; mean distance from a map obstacle that is seen offset
    wall_extension: float = 4.0  # m; by which a wall may be larger than detected so far
    merge_gate: float = 0.25  # m; mean distance of a track's points from another that merges them
    merge_frames: int = 3  # frames in a row for which that must hold


@dataclass(frozen=True, eq=False, repr=False)
class RetentionSettings(SettingsTable):
    """Confirmation, coasting and deletion of tracks."""

    confirmations: int = 2  # clusters after which a track is confirmed
    tentative_time: float = 0.5  # s; without a detection after which a tentative track is deleted
    coasting_after: float = 0.3  # s; without a detection after which a static track coasts at rest
    delete_after: float = 1.0  # s; without a detection in the field of view until deletion
    forget_after: float = 2.0  # s; without a detection out of view until a moving track is deleted
    restorable: float = 3.0  # s; after deletion in which lost sensing restores a track
    in_view_share: Share = 0.8  # share of the range within which detection is certain
    link_timeout: float = 0.3  # s; age of a position up to which a vehicle's field of view counts
    visited_memory: float = 10.0  # s; for which the places are kept that an unpredictable track visited
    visited_before: float = 1.0  # s; ago, from which on a place counts as visited before
    undetected_growth: float = 0.5  # m; growth of a moving map obstacle not detected yet


@dataclass(frozen=True, eq=False, repr=False)
class MapCheckSettings(SettingsTable):
    """Detection of an offset of the obstacles from their places on the map."""

    offset_min: float = 0.2  # m; offset from which on detections contradict the map
    false_alarm: Share = 1e-6  # probability per scan that noise alone is an offset, of all obstacles and vehicles
    duration: float = 0.4  # s; for which it must last: the time until a wrong pose is isolated
    agreement_sigmas: float = 1.25  # mean distance of a scan that agrees, in standard deviations
    agreements: int = 5  # such scans before an offset of the obstacle can be detected
    walk: float = 0.05  # m/sqrt(s); random walk of the offset
    initial_sigma: float = 0.5  # m; initial uncertainty of the offset
    smoothing: Share = 0.3  # share of one scan in the mean scatter of points


@dataclass(frozen=True, eq=False, repr=False)
class ImmSettings(SettingsTable):
    """Motion models of the interacting multiple model (IMM) filter, and their process noise."""

    static_walk: float = 0.01  # m/sqrt(s); static model: random walk of the position
    velocity_walk: float = 0.15  # m/s/sqrt(s); constant-velocity model: random walk of the velocity
    singer_accelerations: tuple[float, ...] = (1.0, 4.0)  # m/s2; Singer models: accelerations
    singer_times: tuple[float, ...] = (1.0, 0.5)  # s; Singer models: their correlation times
    frequencies: tuple[float, ...] = (0.5, 0.7, 1.0, 1.4, 2.0, 2.8)  # rad/s; harmonic models: angular frequencies
    harmonic_walk: float = 0.1  # m/s2/sqrt(s); harmonic models: acceleration's walk at 1 rad/s
    initial_velocity: float = 1.5  # m/s; initial standard deviation of the velocity
    initial_acceleration: float = 1.5  # m/s2; initial standard deviation of the acceleration
    transition_rate: float = 0.1  # 1/s; share of a model's weight that moves to the others

    def __post_init__(self) -> None:
        sigmas, times = len(self.singer_accelerations), len(self.singer_times)
        if sigmas != times:
            raise ParameterError(f"singer_accelerations has {sigmas} values and singer_times {times}: one each a model")


@dataclass(frozen=True, eq=False, repr=False)
class ManoeuvreSettings(SampledSettings):
    """Manoeuvres that no motion model contains, and the growth of predictions for them."""

    rate: float = derived(10.0)
    """Rate of the scans (Hz)."""
    mismatch_begin: float = 0.9  # mean squared innovation (usually 0.5) from which on models fail
    mismatch_full: float = 1.5  # from which on they mismatch wholly
    mismatch_acceleration: float = 2.0  # m/s2; standard deviation of the acceleration then
    innovation_max: float = 10.0  # bound of one squared innovation
    innovation_share: Share = 0.15  # share of one innovation in their mean
    memory: float = 8.0  # s; time constant with which mismatch and prediction error decay
    horizon: float = 1.0  # s; after which predictions are compared with the track
    usual_error: float = 0.15  # m; error of a good prediction over that time, at least
    settling: float = 3.0  # s; after the first detection until predictions are compared
    growth_max: float = 0.5  # m; largest growth of a body while predictions are right
    growth_per_error: float = 1.5  # by which that rises with the prediction error
    growth_limit: float = 1.5  # m; up to which it rises: an obstacle may come faster than the team

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

    model_sigma: float = 0.015  # m; standard deviation of a real surface about its shape
    # m; movement expected on axes on which no point shows it, and of a wall along itself by its ends
    sideways_sigma: float = 0.1
    unseen_sigma: float = 0.5  # m; of the place of a wall along itself while its ends are not seen
    scatter_loss: float = 18.0  # factor of scatter in the uncertainty of a centre: by trial
    radius: float = 0.6  # m; of a sphere or pole before anything is detected: rather too large
    radius_sigma: float = 0.35  # m; its standard deviation
    radius_sigma_min: float = 0.015  # m; least standard deviation of a radius
    radius_walk: float = 0.003  # m; random walk of a radius from frame to frame
    sphere_radius_min: float = 0.1  # m; smallest sphere
    pole_radius_min: float = 0.04  # m; smallest radius of a pole
    radius_max: float = 1.6  # m; largest radius of a sphere or pole
    centre_sigma: float = 2.0  # m; uncertainty of the first guess of a centre
    pole_end_depth: float = 0.1  # m; within a pole's side from which on a point lies on its end
    pole_end_share: float = 0.2  # and share of the radius beside that
    pole_extension: float = 3.0  # m; of a pole above points at the end of the range
    side_extension: float = 1.0  # m; of a wall to the side of them
    top_extension: float = 2.0  # m; of a wall above and below them
    thickness: float = 0.4  # m; of a wall while only its front is detected
    depth_observed: float = 0.12  # m; behind the front from which on points show the thickness
    yaw_sigma: float = 0.1  # rad; initial uncertainty of a wall's heading
    yaw_walk: float = 0.001  # rad; its random walk from frame to frame
    size_sigma_max: float = 0.3  # m; largest uncertainty of a wall's ends from its heading
    end_jump: float = 0.3  # m; from which on an end is somewhere else rather than measured anew
    end_smoothing: Share = 0.2  # share of one frame in the place of an end
    end_retreat: Share = 0.15  # the same where the surface seems much shorter


@dataclass(frozen=True, eq=False, repr=False)
class ObstacleFilterSettings(SettingsTable):
    """Shape and motion of one track."""

    # probability that the true body reaches out of the predicted one, where its growth has no limit
    outside_share: float = 0.01
    static_speed: float = 0.1  # m/s; speed below which a track is static
    static_weight: Share = 0.5  # weight of the static model above which it is
    mover_speed_max: float = 5.0  # m/s; speed above which a track is no obstacle that moves
    # m; edges of a flat face of which both are longer: that is a wall, and does not move
    mover_face_max: float = 1.6
    late_speed: float = 0.5  # m/s; uncertainty of the speed by which late frames are moved
    pole_complexity: float = 0.4  # by which a pole must fit better than a sphere
    wall_complexity: float = 0.8  # by which a wall must fit better than a sphere
    hysteresis: float = 1.0  # by which another shape must fit better than the one so far
    smoothing: Share = 0.3  # share of one frame in the mean score and scatter
    points_min: int = 5  # points of a frame from which shape and scatter are learnt
    every_frame_until: int = 6  # frames in which all shapes are tried
    every_frames: int = 20  # frames after which they are tried again
    retry_score: float = 2.5  # score from which on they are tried at once (about 1 is right)
    scatter_max: float = 0.5  # m; largest standard deviation of the points' scatter
    outermost_sigmas: float = 1.5  # standard deviations by which noise alone puts points outside
    seen_memory: float = 2.0  # s; for which points are remembered that the body must hold
    false_share: Share = 0.01  # share of them that are not of this body
    surfaces: SurfaceSettings = field(default_factory=SurfaceSettings)
    motion: ImmSettings = field(default_factory=ImmSettings)
    manoeuvre: ManoeuvreSettings = field(default_factory=ManoeuvreSettings)


@dataclass(frozen=True, eq=False, repr=False)
class StandingMapSettings(SettingsTable):
    """Standing map: voxels, evidence of free and occupied space, and the bodies that cover it."""

    voxel: float = 0.25  # m; edge of a voxel: three standard deviations of a return at most of the range
    missed_share: float = derived(0.02)
    """Share of the range sensors' rays that return nothing though they hit."""
    false_share: Share = 0.01  # share of returns where nothing is
    false_free: Share = 1e-3  # probability that what fills a voxel is seen free
    false_removal: Share = 1e-5  # probability that what stands is freed by one run of scans that pass it
    false_alarm: Share = 1e-3  # probability that noise leaves a return unexplained
    uncovered: Share = 1e-3  # probability that a surface lies beyond what covers it
    prior_hits: float = 4.0  # scans that hit what stands at a ray's place, before any was counted
    prior_passes: float = 1.0  # scans that pass it by the poses' noise, before any was counted
    hit_share_min: Share = 0.25  # least share of the scans through its place that hit what stands
    hit_share_along: Share = 0.1  # the same of scans along its surface
    memory: float = 64.0  # scans whose hits and passes are remembered
    sigmas_beyond: float = 3.0  # standard deviations by which a ray must end beyond what it passes
    incidence_min: Share = 0.5  # least cosine between a ray that passes through points and their surface's normal
    standing_speed: float = 0.15  # m/s; speed of points below which they count as standing
    tolerance: float = 0.03  # m; to which surfaces are covered without being computed anew
    # of the rays without return, one of so many is followed where nothing stands in its direction
    exploring_stride: int = 4
    bridged_gap: float = 1.0  # m; between points that one body covers without what lies between
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
