"""Figures that take a computation of their own, of seconds at most: each function returns the names of a claim."""

from __future__ import annotations

import csv
import math
import tomllib
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from link_margin_page import hover_loop
from scipy.spatial import KDTree

from gcs.campaign.faults.campaign_file import read_campaign
from gcs.campaign.faults.plans import FaultFlights
from gcs.campaign.scenarios.generator import DEFAULT_KINDS, generate
from gcs.campaign.scenarios.judgement import least_separation
from gcs.campaign.scenarios.passage import SHORT, SPARE, Passages
from gcs.config import SystemConfig
from gcs.flight.stack import reaction_time, speed_by_sight, tilted_formation
from idc_controller.model.drag import drag_coefficients
from idc_controller.model.linear import LinearModel
from idc_controller.parameters import SystemParameters
from idc_controller.perception.range_sensors import RayPattern

ROOT = Path(__file__).parents[2]
_HISTORY = ROOT / "tests" / "benchmarks" / "history.csv"


def geometry() -> dict[str, Any]:
    """Lengths (m) that follow from the default system."""
    system = SystemConfig()
    parameters, passages = system.parameters(), Passages(system)
    margin, spare = system.avoidance.margin, system.guidance.navigator.spare
    radius = passages.formation.radius
    states = {n: len(LinearModel(_team(n)).A) for n in (3, 4)}
    return {
        "uav_above_payload": float((parameters.l - parameters.p[:, 2]).min()),
        "payload_on_pad": system.resting_altitude,
        "passable_gap": 2.0 * (radius + margin + spare + SPARE),
        "impassable_gap": 2.0 * (passages._half_width + margin - SHORT),
        "states_of_uav": states[4] - states[3],
        "states_of_payload": 4 * states[3] - 3 * states[4],
        "separation_limit": parameters.separation(system.control.mpc.separation_share),
        "separation_passed": least_separation(system),
    }


def links() -> dict[str, Any]:
    """Return the delays (ms), not compensated, at which the loop at hover becomes unstable."""
    loop = hover_loop()
    light = loop.delay_margin(SystemConfig().payload.mass / 3.0)
    return {"delay_margin_ms": 1e3 * loop.delay_margin(), "delay_margin_light_ms": 1e3 * light}


def sight() -> dict[str, Any]:
    """Limits of the speed by sight (m/s), and the way to stop (m) from a speed."""
    system = SystemConfig()
    limit = speed_by_sight(system, None)  # type: ignore[arg-type]
    settings, acceleration = limit.settings, limit.settings.limits.acceleration

    def way(speed: float) -> float:
        duration = speed / acceleration + settings.stopping_delay
        return speed * (settings.latency + duration / 2.0)

    reaction = reaction_time(system, tilted_formation(system))
    return {
        "way": way,
        "give_way": reaction - settings.confirmation - system.safety.planner.stage,
        "slow": limit.slow,
        "fastest": limit.fastest,
        "closing": limit.fastest + settings.closing_speed,
    }


def rays() -> dict[str, Any]:
    """Return the largest angle (deg) from a direction in view to a ray, of one scan and of ten in a row."""
    sensor = SystemConfig().range_sensor
    low, high = math.radians(sensor.elevation_min_deg), math.radians(sensor.elevation_max_deg)
    pattern, random = RayPattern(sensor.rays, low, high), np.random.default_rng(1)
    up, azimuth = random.uniform(math.sin(low), math.sin(high), 20_000), random.uniform(0.0, math.tau, 20_000)
    # The gaps at the edges of the field are the largest.
    edge = np.linspace(0.0, math.tau, 10_000)
    up = np.concatenate([up, *(np.full_like(edge, math.sin(angle)) for angle in (low, high))])
    azimuth, level = np.concatenate([azimuth, edge, edge]), np.sqrt(1.0 - up**2)
    places = np.column_stack([level * np.cos(azimuth), level * np.sin(azimuth), -up])
    gaps = {count: _largest_gap(pattern, places, count) for count in (1, 10)}
    return {"one_scan": gaps[1], "ten_scans": gaps[10]}


def courses() -> dict[str, Any]:
    """Count the obstacles of ``gcs courses --count 100 --seed 2711``."""
    system, obstacles = SystemConfig(), []
    for number in range(1, 101):
        scenario = generate(2711, number, DEFAULT_KINDS[(number - 1) % len(DEFAULT_KINDS)], system)
        obstacles += tomllib.loads(scenario.text).get("obstacle", [])
    known = sum(obstacle.get("known", True) for obstacle in obstacles)
    return {"obstacles": len(obstacles), "known": known}


def campaigns() -> dict[str, Any]:
    """Count the flights of the campaign files."""
    return {
        name: sum(1 for _ in FaultFlights(read_campaign(ROOT / "missions" / f"{name}.toml")).plans(ROOT / "runs"))
        for name in ("sphere_faults", "detection", "obstacle_noise", "lost_ground", "lost_vehicle")
    }


def drag() -> dict[str, Any]:
    """Return the largest drag of the wind of the failsafe grid over the payload's weight, whole and lighter."""
    grid = tomllib.loads((ROOT / "missions" / "failsafe_grid.toml").read_text(encoding="utf-8"))
    light = next(fault for fault in grid["fault"] if fault["kind"] == "payload_mass")
    p, wind, less = SystemConfig().parameters(), max(grid["pairs"]["wind"]), light["wind_max"]
    diagonal = np.array([math.sqrt(0.5), math.sqrt(0.5), 0.0])

    def share(speed: float, mass: float) -> float:
        return float(drag_coefficients(p.payload.areas) @ diagonal) * speed**2 / (mass * p.g)

    left = p.m_0 + light["change"]
    return {
        "mass": p.m_0, "lost": -light["change"], "wind": wind, "less_wind": less,
        "whole": share(wind, p.m_0), "light": share(wind, left), "light_in_less": share(less, left),
    }  # fmt: skip


def missions() -> dict[str, Any]:
    """Return the tables of the project's own mission files, by name."""
    return {path.stem: tomllib.loads(path.read_text(encoding="utf-8")) for path in (ROOT / "missions").glob("*.toml")}


def benchmark() -> dict[str, Any]:
    """Return the last row of the history that ``make benchmark`` has written with gym-pybullet-drones' own anchor."""
    with _HISTORY.open(encoding="utf-8") as file:
        row = [row for row in csv.DictReader(file) if row["anchor"] == "gym-pybullet-drones"][-1]
    return {name: float(value) for name, value in row.items() if _is_number(value)}


def _team(vehicles: int) -> SystemParameters:
    system = SystemConfig()
    return replace(system, team=replace(system.team, vehicles=vehicles)).parameters()


def _largest_gap(pattern: RayPattern, places: Any, count: int) -> float:
    rays = np.concatenate([pattern.directions(scan) for scan in range(count)])
    chords, _ = KDTree(rays).query(places)
    return math.degrees(2.0 * math.asin(float(chords.max()) / 2.0))


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True
