"""The numerical simulation of Section IV: one controller on the corrected nonlinear plant, and its evaluation."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from gcs.record.clearance import Formation, ObstacleTrack
from gcs.reproduce.controls import PERIOD, Control, PaperControl, PaperVariant, ProjectControl
from gcs.reproduce.scene import MARGIN, RADIUS, Sphere, configuration, shaped_figure, two_spheres
from idc_controller.arrays import Array, Mask
from idc_controller.geometry.shapes import Sphere as SphereShape
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.rotations import euler_from_quaternion

PROJECT, EXTRAPOLATING = "project", "extrapolating"
"""This project's controller, given where the spheres will be; given their motion now only, as the paper's filter is.
"""
LOST_TILT, LOST_DISTANCE = 60.0, 60.0
"""deg and m: the payload has tipped over, or flown away."""
STEPS = 5
"""Steps of the plant a period; the attitude loop on board runs at each of them, at 100 Hz."""


@dataclass(frozen=True)
class Case:
    """One simulation.

    ``control`` is a reading of the paper, :data:`PROJECT` or :data:`EXTRAPOLATING`; ``duration`` (s) of the figure at
    full rate; ``sigma`` (m/s and rad/s) of noise on the payload's velocity and rates; ``design_mass`` (kg) of the
    controller's payload (None: Table I) and ``plant_mass`` of the plant's (None: the same).
    """

    control: PaperVariant | str
    duration: float
    obstacles: bool = False
    sigma: float = 0.0
    seed: int = 1
    design_mass: float | None = None
    plant_mass: float | None = None
    margin: float = MARGIN


@dataclass(frozen=True, eq=False)
class Flown:
    """The record of a simulation at every control period (T); NED, SI, angles in deg."""

    spheres: tuple[Sphere, ...]
    settled: float
    """Time from which errors and efforts count (s)."""
    took_off: float
    """Time until which the take-off lasts (s)."""
    time: Array
    reference: Array
    position: Array
    quaternion: Array
    uav_position: Array
    uav_quaternion: Array
    u: Array
    avoiding: Mask
    clearance: Array
    """Between hull and spheres (T, number of spheres) (m)."""
    infeasible_tracking: int = 0
    infeasible_avoidance: int = 0
    lost_at: float | None = None
    """Time at which the payload tipped over or flew away (s); None: never."""

    @cached_property
    def angles(self) -> Array:
        """Roll, pitch and yaw of the payload (T, 3) (deg)."""
        return np.asarray(np.degrees(euler_from_quaternion(self.quaternion)))

    def numbers(self) -> dict[str, Any]:
        """Return the evaluation figures of the run; None or NaN where undefined."""
        after = self.time >= self.settled
        error = (self.position - self.reference)[after]
        rmse = np.sqrt(np.mean(error**2, axis=0)) if len(error) else np.full(3, np.nan)
        distances = self.uav_position[:, :, None] - self.uav_position[:, None]
        pairs = np.triu_indices(self.uav_position.shape[1], 1)
        separation = np.linalg.norm(distances, axis=-1)[:, pairs[0], pairs[1]]
        early = self.time < self.took_off
        tilt = np.abs(self.angles)
        least = self.clearance.min(axis=0)
        result = {
            "rmse_m": dict(zip("xyz", rmse.tolist(), strict=True)) | {"total": float(np.sqrt(np.sum(rmse**2)))},
            **{f"{axis}_max_deg": float(tilt[:, i].max()) for i, axis in enumerate(("roll", "pitch", "yaw"))},
            "take_off_tilt_max_deg": float(tilt[early, :2].max()) if early.any() else None,
            "tilt_max_after_take_off_deg": float(tilt[~early, :2].max()) if (~early).any() else None,
            "uav_separation_min_m": float(separation.min()),
            "effort_mean": float(np.linalg.norm(self.u[after], axis=1).mean()) if after.any() else None,
            "height_max_m": float(-self.position[:, 2].min()),
            "lateral_deviation_max_m": float(np.linalg.norm(error[:, :2], axis=1).max()) if len(error) else None,
            "steps": len(self.time),
            "tracking_infeasible_steps": self.infeasible_tracking,
            "avoidance_infeasible_steps": self.infeasible_avoidance,
            "avoiding_s": float(PERIOD * self.avoiding.sum()),
            "lost_at_s": self.lost_at,
        }
        if self.spheres:
            result["clearance_min_m"] = float(least.min())
        return result | {f"clearance_{s.name}_m": float(value) for s, value in zip(self.spheres, least, strict=True)}

    def avoidance_intervals(self) -> list[tuple[float, float]]:
        """Return the intervals in which obstacles were avoided (s), gaps below half a second closed."""
        found: list[tuple[float, float]] = []
        for time in self.time[self.avoiding].tolist():
            if found and time - found[-1][1] < 0.5:
                found[-1] = (found[-1][0], time + PERIOD)
            else:
                found.append((time, time + PERIOD))
        return found


def simulate(case: Case) -> Flown:
    """Simulate ``case``, reproducibly and within this process."""
    table = configuration().parameters()
    design = table if case.design_mass is None else table.with_payload_mass(case.design_mass)
    truth = design if case.plant_mass is None else design.with_payload_mass(case.plant_mass)
    shaped, variant = shaped_figure(case.duration), case.control
    as_printed = isinstance(variant, PaperVariant) and variant.tracking != "flat"
    spheres = two_spheres(np.pi if as_printed else shaped.meets) if case.obstacles else ()
    control: Control
    if isinstance(variant, PaperVariant):
        control = PaperControl(design, variant, None if as_printed else shaped.trajectory, spheres, case.margin)
    else:
        control = ProjectControl(design, shaped.trajectory, spheres, case.margin, variant == EXTRAPOLATING)
    end = case.duration if as_printed else shaped.full_rate + case.duration

    plant, rng = Plant(truth), np.random.default_rng(case.seed)
    state, lost_at = PlantState.hovering(truth, np.zeros(3)), None
    rows: list[tuple[Any, ...]] = []
    for time in (k * PERIOD for k in range(round(end / PERIOD) + 1)):
        control.decide(time, _measured(state, case.sigma, rng))
        for step in range(STEPS):
            thrust, torque = control.act(state, PERIOD / STEPS)
            if step == 0:
                u = np.column_stack([thrust, torque]).ravel()
                pose = (state.r_0, state.quaternion_0, plant.uav_positions(state), state.quaternion)
                rows.append((time, *pose, u, control.avoiding))
            state = plant.step(state, thrust, torque, PERIOD / STEPS)
        if _lost(state):
            lost_at = time + PERIOD
            break
    times, r_0, attitude, uavs, attitudes, u, avoiding = (np.array(column) for column in zip(*rows, strict=True))
    tracks = [ObstacleTrack(s.name, SphereShape(RADIUS), s.motion(times)[0]) for s in spheres]
    return Flown(
        spheres, 10.0 if as_printed else shaped.full_rate, 5.0 if as_printed else shaped.full_rate,
        times, control.reference(times), r_0, attitude, uavs, attitudes, u, avoiding,
        Formation(r_0, attitude, uavs, attitudes, truth.payload, truth.disc_radius).clearances(tracks),
        control.infeasible_tracking, control.infeasible_avoidance, lost_at,
    )  # fmt: skip


def _measured(state: PlantState, sigma: float, rng: np.random.Generator) -> PlantState:
    if sigma == 0.0:
        return state
    noise = sigma * rng.normal(size=6)
    return replace(state, v_0=state.v_0 + noise[:3], omega_0=state.omega_0 + noise[3:])


def _lost(state: PlantState) -> bool:
    if not (np.all(np.isfinite(state.r_0)) and np.all(np.isfinite(state.omega))):
        return True
    angles = np.degrees(euler_from_quaternion(state.quaternion_0))
    return bool(np.abs(angles[:2]).max() > LOST_TILT or np.linalg.norm(state.r_0) > LOST_DISTANCE)
