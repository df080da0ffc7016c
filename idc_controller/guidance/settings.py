"""Settings of the guidance: progress along the mission, and detours."""

from dataclasses import dataclass

from idc_controller.settings import SettingsTable, Share, derived, setting
from idc_controller.trajectory.settings import AvoidanceSettings, Limits


@dataclass(frozen=True, eq=False, repr=False)
class ProgressSettings(SettingsTable):
    """Answer of the progress along the mission to lag and wind."""

    # how long a reference and its plan stay, as a share of the planner's stage: plans made more often have their stages
    # between those of the plan before, and the two disagree by turns
    stage_share: Share = 0.7
    slowing_lag: float = 1.2  # m; lag over which the progress rate falls from 1 to 0
    lag_at_rest: float = 2.4  # m; lag from which the progress rests
    rate_step: float = 0.05  # largest change of the progress rate from reference to reference
    # the same where wind limits it: predicted for long, and a fast change would be a disturbance; and of its rise where
    # sight does
    rate_step_in_wind: float = 0.01
    drag_limit: float = 0.45  # drag on the payload, over its weight, above which the rate is lowered
    slowest_in_wind: Share = 0.6  # rate that wind does not lower it beyond: slower counts as held up


@dataclass(frozen=True, eq=False, repr=False)
class DetourSettings(SettingsTable):
    """Search of a path on a grid, and its straightening."""

    spacing: float = 0.5  # m; between the nodes of the grid
    # m; horizontally, where that finds no path: gaps some 0.3 m wider than they must be are found
    fine_spacing: float = 0.25
    nodes_max: int = 160_000  # nodes beyond which the grid is coarser
    around: float = 4.0  # m; of region beyond start, goal and the obstacles about them
    region_max: float = 80.0  # m; largest edge of the region, unless start and goal are farther apart
    leave_within: float = 3.0  # m; from a start too near an obstacle to free space
    waypoint_cost: float = 0.15  # m; of path that one waypoint less is worth
    straightened: int = 40  # points among which the straightening chooses its waypoints


@dataclass(frozen=True, eq=False, repr=False)
class NavigatorSettings(SettingsTable):
    """Conditions in which a detour is searched, and how it is flown."""

    limits: Limits = derived(Limits())
    """Limits of the trajectories: table ``motion``."""
    margin: float = derived(AvoidanceSettings.margin)
    """Clearance to keep between hull and obstacles (m): ``avoidance.margin``."""
    spare: float = setting(
        0.2,
        "m",
        "more than the margin, where there is such a path: the safety filter then need not act on a detour",
        ge=0.0,
    )
    corner: float = 0.1  # m; by how much a detour's corners are cut
    link_tilt: float = 0.08726646259971647  # rad; link tilt for which a detour leaves clearance
    held_up_rate: Share = 0.5  # progress rate below which the mission is held up
    patience: float = 0.5  # s; how long it may be held up before a detour is searched
    begin_speed: float = 0.5  # m/s; of the payload, up to which a detour may begin: it begins at rest
    search_interval: float = 1.0  # s; between searches, at first
    search_interval_max: float = 8.0  # s; between searches that find nothing, at most
    give_up: float = setting(15.0, "s", "held up for so long without a detour, the mission counts as blocked", gt=0.0)
    look_ahead: float = 60.0  # s; how far along the mission its continuation is searched
    sample: float = 0.25  # s; spacing of that search
    behind: float = 6.0  # s; how far back a waypoint may lie that was not reached
    ground_clearance: float = setting(0.10, "m", "least height of the payload's underside on a detour", ge=0.0)
    climb: float = 8.0  # m; how far above the mission a detour may lead
    rejoin: float = 0.3  # s; before the end of a detour the mission is followed again
    goal_spare: float = 2.0  # s; how much farther along the mission a second goal is tried
    standing: float = 0.2  # m; an obstacle that moves less over the planner's stages does not leave a waypoint free
    resumed_rate: Share = 0.9  # progress rate above which the mission is no longer held up
    detour: DetourSettings = derived(DetourSettings())
    """Table ``guidance.detour``."""


@dataclass(frozen=True, eq=False, repr=False)
class SightSettings(SettingsTable):
    """Speed by sight: the progress is such that the formation can stop before space that was not seen free."""

    limits: Limits = derived(Limits())
    """Limits of the motion by which it stops: table ``motion``."""
    margin: float = derived(AvoidanceSettings.margin)
    """Clearance to keep between hull and obstacles (m): ``avoidance.margin``."""
    latency: float = setting(
        0.4, "s", "from a ray until the reference slows down: scan, telemetry, map, progress and set-points", ge=0.0
    )
    horizon: float = 4.8  # s; of the plan that is compared with what was seen
    samples: int = 49  # places of the formation within that
    slowest: Share = 0.2  # progress rate at which the way is looked at where the mission is slower or at rest
    blind_speed: float = setting(
        1.0,
        "m/s",
        "speed of the mission's climb or descent into space above or below the field of view of all range sensors: "
        "nothing there is seen in time",
        gt=0.0,
    )
    closing_speed: float = setting(
        0.4, "m/s", "of moving obstacles that may come into sight, for which the own speed leaves time", ge=0.0
    )
    mover_radius: float = setting(0.5, "m", "of a moving obstacle to which there is time to give way", ge=0.0)
    confirmation: float = setting(
        0.7,
        "s",
        "from coming into range until an obstacle is known to move: scans, telemetry, map and evidence of its motion",
        ge=0.0,
    )

    @property
    def stopping_delay(self) -> float:
        """Time of a stop beyond speed over deceleration (s): jerk, snap and crackle are limited."""
        return self.limits.stopping_time(0.0)


@dataclass(frozen=True, eq=False, repr=False)
class RestingPlaceSettings(SettingsTable):
    """Choice of the place where a team without set-points comes to rest."""

    margin: float = derived(AvoidanceSettings.margin)
    """Clearance to keep between hull and obstacles (m): ``avoidance.margin``."""
    drift: float = 0.3  # m; more than the margin: vehicles without set-points deviate from the plan
    look_ahead: float = 10.0  # s; how far ahead obstacles are predicted
    samples: int = 21  # moments within that
    growth_max: float = 0.5  # m; largest growth of an uncertain obstacle that counts
    durations: tuple[float, ...] = (0.7, 1.3, 1.6, 2.0)  # braking times tried, over the usual one
    aside: tuple[float, ...] = (0.8, 1.6, 2.4)  # m; distances tried from the place to which the motion leads
    bearings: int = 8  # directions in which these are tried
    deceleration_share: float = 4.0 / 3.0  # deceleration of the stop over the acceleration between waypoints
    cost: float = 0.1  # clearance (m) for which a metre aside is too much
    duration_cost: float = 2.0  # m; what a doubled or spared braking time counts as, in metres aside

    @property
    def clearance(self) -> float:
        """Least planned distance from the formation's upright hull to any obstacle (m)."""
        return self.margin + self.drift
