"""The numerical simulation of Section IV: one of the controls on the corrected nonlinear plant, and what came of it."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from gcs.record.clearance import ObstacleTrack, clearance_over_time
from gcs.reproduce.controls import PERIOD, Control, PaperControl, PaperVariant, ProjectControl
from gcs.reproduce.scene import MARGIN, RADIUS, Sphere, configuration, shaped_figure, two_spheres
from idc_controller.geometry.sphere import Sphere as SphereShape
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.parameters import SystemParameters
from idc_controller.rotations import euler_from_quaternion

Array = NDArray[np.float64]

PROJECT = "project"
LOST_TILT, LOST_DISTANCE = 60.0, 60.0
"""deg and m: the payload has tipped over, or flown away."""
STEPS = 5
"""Steps of the plant a period; the attitude loop on board runs at each of them, at 100 Hz."""


@dataclass(frozen=True)
class Case:
    """One simulation.

    ``control`` is a reading of the paper or ``"project"``; ``duration`` (s) of the figure at full rate; ``sigma``
    (m/s and rad/s) of noise on the payload's velocity and rates; ``mass_factor`` of the plant's payload over the
    ``design_mass`` (kg; None: Table I).
    """

    name: str
    control: PaperVariant | str
    duration: float
    obstacles: bool = False
    sigma: float = 0.0
    seed: int = 1
    design_mass: float | None = None
    plant_mass: float | None = None
    margin: float = MARGIN


@dataclass(eq=False)
class Flown:
    """What happened, at every control period; NED, SI, angles in deg."""

    case: Case
    spheres: tuple[Sphere, ...]
    settled: float
    """Time from which errors and efforts count (s)."""
    took_off: float
    """Time until which the take-off lasts (s)."""
    time: Array = field(default_factory=lambda: np.zeros(0))
    reference: Array = field(default_factory=lambda: np.zeros((0, 3)))
    position: Array = field(default_factory=lambda: np.zeros((0, 3)))
    angles: Array = field(default_factory=lambda: np.zeros((0, 3)))
    quaternion: Array = field(default_factory=lambda: np.zeros((0, 4)))
    uav_position: Array = field(default_factory=lambda: np.zeros((0, 4, 3)))
    uav_quaternion: Array = field(default_factory=lambda: np.zeros((0, 4, 4)))
    u: Array = field(default_factory=lambda: np.zeros((0, 16)))
    avoiding: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=bool))
    clearance: Array = field(default_factory=lambda: np.zeros((0, 0)))
    infeasible_tracking: int = 0
    infeasible_avoidance: int = 0
    lost_at: float | None = None
    """When the payload tipped over or flew away (s); None: never."""

    def numbers(self) -> dict[str, Any]:
        """Evaluation figures of the run; None where undefined."""
        after = self.time >= self.settled
        error = (self.position - self.reference)[after]
        rmse = np.sqrt(np.mean(error**2, axis=0)) if len(error) else np.full(3, np.nan)
        distances = self.uav_position[:, :, None] - self.uav_position[:, None]
        pairs = np.triu_indices(self.uav_position.shape[1], 1)
        separation = np.linalg.norm(distances, axis=-1)[:, pairs[0], pairs[1]]
        early = self.time < self.took_off
        tilt = np.abs(self.angles)
        result = {
            "rmse_m": dict(zip("xyz", rmse.tolist(), strict=True)) | {"total": float(np.sqrt(np.sum(rmse**2)))},
            "roll_max_deg": float(tilt[:, 0].max()),
            "pitch_max_deg": float(tilt[:, 1].max()),
            "yaw_max_deg": float(tilt[:, 2].max()),
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
            least = self.clearance.min(axis=0)
            result["clearance_min_m"] = float(least.min())
            result |= {
                f"clearance_{sphere.name}_m": float(value) for sphere, value in zip(self.spheres, least, strict=True)
            }
        return {name: _plain(value) for name, value in result.items()}

    def avoidance_intervals(self) -> list[tuple[float, float]]:
        """When obstacles were avoided (s), gaps below half a second closed."""
        found: list[tuple[float, float]] = []
        for time in self.time[self.avoiding].tolist():
            if found and time - found[-1][1] < 0.5:
                found[-1] = (found[-1][0], time + PERIOD)
            else:
                found.append((time, time + PERIOD))
        return found


def simulate(case: Case) -> Flown:
    """Fly ``case``: repeatable, and it needs nothing but this process."""
    config = configuration()
    table = config.parameters()
    design = table if case.design_mass is None else table.with_payload_mass(case.design_mass)
    truth = design if case.plant_mass is None else design.with_payload_mass(case.plant_mass)
    as_printed = isinstance(case.control, PaperVariant) and case.control.tracking != "flat"
    figure = shaped_figure(case.duration)
    meets = np.pi if as_printed else figure.meets
    spheres = two_spheres(meets) if case.obstacles else ()
    control = _control(case, design, spheres)
    end = case.duration if as_printed else figure.full_rate + case.duration
    flown = Flown(case, spheres, 10.0 if as_printed else figure.full_rate, 5.0 if as_printed else figure.full_rate)
    _run(flown, control, truth, end)
    return flown


def _control(case: Case, design: SystemParameters, spheres: tuple[Sphere, ...]) -> Control:
    figure = shaped_figure(case.duration).trajectory
    if isinstance(case.control, PaperVariant):
        flat = figure if case.control.tracking == "flat" else None
        return PaperControl(design, case.control, flat, spheres, case.margin)
    return ProjectControl(design, figure, spheres, case.margin)


def _run(flown: Flown, control: Control, truth: SystemParameters, end: float) -> None:
    plant, rng = Plant(truth), np.random.default_rng(flown.case.seed)
    state = PlantState.hovering(truth, np.zeros(3))
    rows: list[tuple[Any, ...]] = []
    for k in range(round(end / PERIOD) + 1):
        time = k * PERIOD
        control.decide(time, _measured(state, flown.case.sigma, rng))
        thrust, torque = control.act(state, PERIOD / STEPS)
        rows.append(
            (
                time, state.r_0, state.quaternion_0, plant.uav_positions(state), state.quaternion,
                np.column_stack([thrust, torque]).ravel(), control.avoiding,
            )
        )  # fmt: skip
        for step in range(STEPS):
            if step:
                thrust, torque = control.act(state, PERIOD / STEPS)
            state = plant.step(state, thrust, torque, PERIOD / STEPS)
        if _lost(state):
            flown.lost_at = time + PERIOD
            break
    times, position, quaternion, uavs, uav_quaternion, u, avoiding = (
        np.array(part) for part in zip(*rows, strict=True)
    )
    flown.time, flown.position, flown.quaternion, flown.u, flown.avoiding = times, position, quaternion, u, avoiding
    flown.uav_position, flown.uav_quaternion = uavs, uav_quaternion
    flown.angles = np.degrees(euler_from_quaternion(quaternion))
    flown.reference = control.reference(times)
    flown.infeasible_tracking, flown.infeasible_avoidance = control.infeasible_tracking, control.infeasible_avoidance
    tracks = [ObstacleTrack(s.name, SphereShape(RADIUS), s.motion(times)[0]) for s in flown.spheres]
    if tracks:
        flown.clearance = clearance_over_time(
            position, quaternion, uavs, uav_quaternion, tracks, truth.payload.vertices, truth.disc_radius
        )


def _measured(state: PlantState, sigma: float, rng: np.random.Generator) -> PlantState:
    if sigma == 0.0:
        return state
    noise = sigma * rng.normal(size=6)
    return PlantState(
        state.r_0, state.v_0 + noise[:3], state.quaternion_0, state.omega_0 + noise[3:],
        state.q, state.q_dot, state.quaternion, state.omega,
    )  # fmt: skip


def _lost(state: PlantState) -> bool:
    if not (np.all(np.isfinite(state.r_0)) and np.all(np.isfinite(state.omega))):
        return True
    angles = np.degrees(euler_from_quaternion(state.quaternion_0))
    return bool(np.abs(angles[:2]).max() > LOST_TILT or np.linalg.norm(state.r_0) > LOST_DISTANCE)


def _plain(value: Any) -> Any:
    """Without numbers that are none."""
    if isinstance(value, dict):
        return {name: _plain(part) for name, part in value.items()}
    return None if isinstance(value, float) and not np.isfinite(value) else value
