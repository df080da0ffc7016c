"""``numbers.json``: every number that ``docs/paper.md`` quotes, from the model, the simulations and the flights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from gcs.record.run_data import RunData, read_run
from gcs.record.summary import payload_angles
from gcs.reproduce.controls import PERIOD
from gcs.reproduce.plan import DESIGN_MASS, Plan
from gcs.reproduce.scene import configuration, printed_reference, shaped_figure
from gcs.reproduce.work import Results
from idc_controller.arrays import Array
from idc_controller.model import nonlinear
from idc_controller.model.linear import discretised
from idc_controller.model.nonlinear import Inputs, SystemState
from idc_controller.paper import printed_equations as printed
from idc_controller.paper import state_space
from idc_controller.paper.avoidance import linear_acceleration
from idc_controller.paper.plant import Plant, PlantState
from idc_controller.paper.state_space import Layout
from idc_controller.parameters import SystemParameters, polygon_attachments

_STATES = 20
"""Random states at which the printed equations are evaluated."""


def numbers(plan: Plan, results: Results) -> dict[str, Any]:
    """Return the numbers of a run; a quick one has fewer."""
    found: dict[str, Any] = {"quick": plan.quick, "model": model_numbers()}
    for (section, name), flown in sorted(results.simulations.items()):
        found.setdefault(section, {})[name] = flown.numbers()
    _effort_against_design(found.get("mass", {}))
    if "noise" in found:
        found["noise_worst"] = _worst_by_sigma(found["noise"])
    found["flights"] = {name: flight_numbers(read_run(folder)) for name, folder in sorted(results.folders.items())}
    return found


def flight_numbers(run: RunData) -> dict[str, Any]:
    """Return figures of a flight's summary, and its figures until the first contact."""
    summary = run.summary
    contacts = run.contacts if run.contacts is not None else np.zeros(len(run.time))
    powered = (run.thrust > 0.0).any(axis=1)
    in_contact = np.flatnonzero((contacts > 0) & powered)
    before = slice(0, in_contact[0] + 1 if len(in_contact) else len(run.time))
    return {
        "outcome": summary["outcome"],
        "clearance_min_m": summary["clearance_min_m"],
        "contacts": summary["contacts"],
        "tilt_max_deg": max(summary["payload_tilt_max_deg"].values()),
        "uav_separation_min_m": summary["uav_separation_min_m"],
        "rmse_m": summary["position_rmse_m"]["total"],
        "duration_s": summary["duration_s"],
        "first_contact_s": float(run.time[in_contact[0]]) if len(in_contact) else None,
        "touched_first": _touched_first(run, in_contact[0]) if len(in_contact) else None,
        "tilt_max_before_contact_deg": float(np.abs(payload_angles(run)[before, :2]).max()),
        "clearance_before_contact_m": float(np.nanmin(run.clearance[before])),
    }


def _touched_first(run: RunData, row: int) -> str:
    """Return the name of the obstacle of the first contact, in a ``row``, or that two UAVs touched each other."""
    clearance = run.clearances(slice(row, row + 1))[0]
    return run.obstacles[int(np.argmin(clearance))].name if clearance.min() < 0.01 else "one UAV another"


def model_numbers() -> dict[str, Any]:
    """Return the numbers that follow from the equations, without a simulation."""
    p = configuration().parameters()
    A, B = state_space.linearised(p)
    A_small, B_small = state_space.minimal(p)
    T = state_space.embedding(p)
    modes, modes_small = (
        state_space.uncontrollable_modes(*discretised(*pair, PERIOD)) for pair in ((A, B), (A_small, B_small))
    )
    G = linear_acceleration(p)[1]
    errors = [_errors_of(seed) for seed in range(_STATES)]
    return {
        "state_printed": printed.printed_state_dimension(4),
        "state": len(A),
        "state_minimal": len(A_small),
        "uncontrollable_modes": len(modes),
        "uncontrollable_modes_minimal": len(modes_small),
        "uncontrollable_mode": float(np.mean(np.real(modes))),
        "minimal_against_full": float(max(np.abs(A @ T - T @ A_small).max(), np.abs(B - T @ B_small).max())),
        "relative_degrees": _degrees(p),
        "A_obs_per_thrust": {axis: float(-2.0 * G[i, 0]) for i, axis in enumerate("xyz")},
        "hover_thrust_n": {str(N): _hover_thrusts(p, N) for N in (3, 4, 6)},
        "printed_fall_mps2": _printed_fall(p),
        "P_asymmetry": float(max(w["asymmetry"] for w in errors)),
        "P_acceleration_error_median": float(np.median([w["acceleration"] for w in errors])),
        "moment_residual_printed_nm": float(np.median([w["moment_printed"] for w in errors])),
        "moment_residual_nm": float(max(w["moment"] for w in errors)),
        "lagrange_moment_error_nm": float(np.median([w["lagrange"] for w in errors])),
        "derivations_difference": float(max(w["derivations"] for w in errors)),
        "hull": _hull(p),
    }


def _degrees(p: SystemParameters) -> dict[str, dict[str, int | str]]:
    """Return the lowest derivative of each axis of r_0 that an input of any UAV reaches, at hover."""
    A, B = state_space.minimal(p)
    degrees = state_space.relative_degrees(A, B, np.eye(3, len(A)))
    names = ("thrust", "tau_x", "tau_y", "tau_z")
    return {
        name: {axis: min((int(d) for d in degrees[i, k::4] if d > 0), default="never") for i, axis in enumerate("xyz")}
        for k, name in enumerate(names)
    }


def _hover_thrusts(p: SystemParameters, N: int) -> dict[str, float]:
    parameters = replace(
        p, m=np.full(N, p.m[0]), J=np.tile(p.J[0], (N, 1, 1)), l=np.full(N, p.l[0]),
        p=polygon_attachments(N, 1.0, float(p.p[0, 2])),
    )  # fmt: skip
    return {
        "printed": float(printed.printed_hover_thrust(parameters)[0]),
        "correct": float(parameters.hover_thrust[0]),
    }


def _printed_fall(p: SystemParameters) -> float:
    """Return the vertical acceleration at hover with the printed direction of thrust (m/s2)."""
    hover = PlantState.hovering(p, np.zeros(3))
    state = SystemState(
        hover.r_0, hover.v_0, hover.quaternion_0, hover.omega_0, hover.q, np.zeros_like(hover.q),
        hover.quaternion, hover.omega,
    )  # fmt: skip
    F = printed.printed_thrust_forces(state.quaternion, p.hover_thrust)
    return float(nonlinear.accelerations(p, state, Inputs(F, np.zeros((p.number_of_uavs, 3)))).r_0_ddot[2])


def _errors_of(seed: int) -> dict[str, float]:
    """Return the errors of the printed equations at a random state: links about 20 degrees off, rates 0.5 rad/s."""
    p = configuration().parameters()
    rng = np.random.default_rng(seed)
    state = _random_state(p, rng, 0.5)
    N = p.number_of_uavs
    thrust, torque = p.hover_thrust * rng.uniform(0.8, 1.2, N), 0.1 * rng.normal(size=(N, 3))
    inputs = Inputs(nonlinear.thrust_forces(state.quaternion, thrust), torque)
    P = printed.printed_matrix_P(p, state.q)
    right = np.linalg.solve(nonlinear.matrix_P(p, state.q), nonlinear.vector_Q(p, state, inputs))
    second = nonlinear.accelerations(p, state, inputs)
    R_0 = state.R_0
    plant = PlantState(
        state.r_0, state.r_0_dot, state.quaternion_0, state.omega_0, state.q @ R_0.T,
        np.cross(state.Omega, state.q) @ R_0.T, state.quaternion, state.omega,
    )  # fmt: skip
    other = Plant(p).accelerations(plant, thrust, torque)
    lagrange = [printed.generalised_moment(p, state, inputs, printed=which) for which in (True, False)]
    return {
        "asymmetry": float(np.abs(P - P.T).max()),
        "acceleration": float(np.linalg.norm((printed.printed_accelerations(p, state, inputs) - right)[:3])),
        "moment_printed": printed.moment_residual(p, state, inputs, printed=True),
        "moment": printed.moment_residual(p, state, inputs, printed=False),
        "lagrange": float(np.linalg.norm(lagrange[0] - lagrange[1])),
        "derivations": float(
            max(np.abs(other[0] - second.r_0_ddot).max(), np.abs(other[1] - second.omega_0_dot).max())
        ),
    }


def _random_state(p: SystemParameters, rng: np.random.Generator, rate: float) -> SystemState:
    N = p.number_of_uavs

    def tilted(count: int) -> Array:
        q = np.column_stack([np.ones(count), 0.1 * rng.normal(size=(count, 3))])
        return np.asarray(q / np.linalg.norm(q, axis=1, keepdims=True))

    q = np.column_stack([0.2 * rng.normal(size=(N, 2)), np.ones(N)])
    q /= np.linalg.norm(q, axis=1, keepdims=True)
    Omega = rate * rng.normal(size=(N, 3))
    return SystemState(
        rng.normal(size=3), rng.normal(size=3), tilted(1)[0], rate * rng.normal(size=3), q,
        Omega - np.sum(Omega * q, axis=1, keepdims=True) * q, tilted(N), rate * rng.normal(size=(N, 3)),
    )  # fmt: skip


def _hull(p: SystemParameters) -> dict[str, float]:
    """Return the tilt of the links and the UAVs' shift relative to the payload on the figure eight."""
    times = np.linspace(0.0, 4.0 * np.pi, 2001)
    h = 1e-3
    r = [printed_reference(times + offset) for offset in (-h, 0.0, h)]
    acceleration = float(np.linalg.norm((r[2] - 2.0 * r[1] + r[0]) / h**2, axis=1).max())
    tilt = float(np.arctan2(acceleration, p.g))
    speed = float(np.linalg.norm((r[2] - r[0]) / (2.0 * h), axis=1)[0])
    return {
        "acceleration_max_mps2": acceleration,
        "link_tilt_max_deg": float(np.degrees(tilt)),
        "uav_shift_max_m": float(p.l[0] * np.sin(tilt)),
        "speed_at_start_mps": speed,
        "shaped_full_rate_s": shaped_figure(8.0).full_rate,
    }


def _effort_against_design(mass: dict[str, Any]) -> None:
    """Add to each mass by how much its effort differs from that with the design mass (%)."""
    for name, found in mass.items():
        design = mass.get(f"{name.rsplit('_', 1)[0]}_{DESIGN_MASS:g}")
        if design is not None and found["effort_mean"] is not None and design["effort_mean"]:
            found["effort_change_percent"] = 100.0 * (found["effort_mean"] / design["effort_mean"] - 1.0)


def _worst_by_sigma(noise: dict[str, Any]) -> dict[str, dict[str, dict[str, Any]]]:
    """Return the worst figures of all seeds, by controller and sigma."""
    worst: dict[str, dict[str, dict[str, Any]]] = {}
    for name, found in noise.items():
        control, sigma, _ = name.split("_")
        entry = worst.setdefault(control, {}).setdefault(
            sigma, {"roll_max_deg": 0.0, "pitch_max_deg": 0.0, "clearance_min_m": np.inf, "lost": 0, "flown": 0}
        )
        entry["flown"] += 1
        entry["lost"] += found["lost_at_s"] is not None
        for key in ("roll_max_deg", "pitch_max_deg"):
            entry[key] = max(entry[key], found[key])
        entry["clearance_min_m"] = min(entry["clearance_min_m"], found["clearance_min_m"])
    return worst


def matrices() -> dict[str, tuple[Array, Sequence[str], Sequence[str]]]:
    """Return the matrices of the paper's external file, with labels of rows and of columns, at hover and 20 Hz."""
    p = configuration().parameters()
    full, small, inputs = Layout.full(4).names(), Layout.minimal(4).names(), state_space.input_names(4)
    continuous = state_space.linearised(p)
    (A, B), (A_small, B_small) = (discretised(*pair, PERIOD) for pair in (continuous, state_space.minimal(p)))
    return {
        "A_continuous": (continuous[0], full, full), "B_continuous": (continuous[1], full, inputs),
        "A": (A, full, full), "B": (B, full, inputs),
        "A_minimal": (A_small, small, small), "B_minimal": (B_small, small, inputs),
        "minimal_to_full": (state_space.embedding(p), full, small),
    }  # fmt: skip
