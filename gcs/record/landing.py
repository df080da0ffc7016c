"""Landing figures: touchdown speed, whether the payload is upright on the ground, contacts before."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from gcs.record.clearance_kernels import lower_clearance
from gcs.record.run_data import RunData
from idc_controller.arrays import Array, Mask
from idc_controller.rotations import rotation_from_quaternion

UPRIGHT_DEG = 15.0
TOUCHDOWN_SPEED = 1.0
"""m/s: a payload that touches the ground faster was dropped, not set down."""

_TOUCHING = 0.02  # m between the lowest corner and what is under it
_AIRBORNE = 0.1  # m
_AT_REST = 0.1  # m/s
_STOPPED = 0.5  # N of a UAV's thrust


def landing_figures(run: RunData) -> dict[str, Any] | None:
    """Return the ``landing`` entry of the summary, from the truth; None without one.

    ``touchdown_s``: when the payload touched the ground for good (s, the clock of the tables). ``speed_mps`` and
    ``sinking_mps``: its largest speed, and the largest of its speed downwards, wherever it touched after take-off
    (m/s; 0 if it never left the ground). ``tilt_deg``: its angle to upright at the end (deg). ``on_ground``: it rests
    on ground or pad at the end, at rest, all rotors stopped. ``contacts_before``: how often a pair of parts began to
    touch until then. What never happened is None.
    """
    if run.source != "truth" or run.contacts is None or len(run.time) == 0:
        return None
    rotation = rotation_from_quaternion(run.payload_quaternion)
    height = _height(run, rotation)
    airborne = np.flatnonzero(height > _AIRBORNE)
    touching = height <= _TOUCHING
    speed = np.linalg.norm(run.payload_velocity, axis=1)
    fastest: float | None = 0.0
    down: float | None = 0.0
    touchdown = 0
    if len(airborne):
        # With the row before each: the ground has not slowed it yet.
        near = touching.copy()
        near[:-1] |= touching[1:]
        near[: airborne[0]] = False
        for row in _stands(run, touching)[:-1]:  # a lift-off is no landing
            near[row : row + int(np.argmax(height[row:] > _AIRBORNE))] = False
        fastest = float(speed[near].max()) if near.any() else None
        down = float(max(run.payload_velocity[near, 2].max(), 0.0)) if near.any() else None
        after = np.flatnonzero(touching[airborne[-1] :])
        touchdown = int(airborne[-1] + after[0]) if len(after) else len(run.time)
    landed = bool(len(airborne)) and touchdown < len(run.time)
    stopped = bool(np.all(run.thrust[-1] < _STOPPED))
    return {
        "on_ground": bool(touching[-1] and speed[-1] < _AT_REST and stopped),
        "tilt_deg": float(np.rad2deg(np.arccos(np.clip(rotation[-1, 2, 2], -1.0, 1.0)))),
        "touchdown_s": float(run.time[touchdown]) if landed else None,
        "speed_mps": fastest,
        "sinking_mps": down,
        "contacts_before": onsets(run.contacts[:touchdown]),
    }


def stops(run: RunData) -> list[dict[str, float | None]] | None:
    """Return the ``stops`` entry of the summary, from the truth: a row for each landing; None with fewer than two.

    A landing ends with all rotors stopped. ``touchdown_s``, ``speed_mps``, ``sinking_mps``: as of
    :func:`landing_figures`, where the payload touches the ground from that lift-off on. ``tilt_deg``, ``north_m``,
    ``east_m``: as it stands then.
    """
    if run.source != "truth" or len(run.time) == 0:
        return None
    rotation = rotation_from_quaternion(run.payload_quaternion)
    height = _height(run, rotation)
    touching, airborne = height <= _TOUCHING, height > _AIRBORNE
    speed = np.linalg.norm(run.payload_velocity, axis=1)
    found: list[dict[str, float | None]] = []
    since = 0
    for row in _stands(run, touching):
        flown = since + np.flatnonzero(airborne[since:row])
        since = row
        if not len(flown):
            continue
        touched = int(flown[-1] + np.flatnonzero(touching[flown[-1] :])[0])
        contact = touching[flown[0] : row + 1].copy()
        contact[:-1] |= contact[1:]
        near = flown[0] + np.flatnonzero(contact)
        north, east, _ = run.payload_position[row].tolist()
        found.append(
            {
                "touchdown_s": float(run.time[touched]),
                "speed_mps": float(speed[near].max()),
                "sinking_mps": float(max(run.payload_velocity[near, 2].max(), 0.0)),
                "tilt_deg": float(np.rad2deg(np.arccos(np.clip(rotation[row, 2, 2], -1.0, 1.0)))),
                "north_m": north,
                "east_m": east,
            }
        )
    return found if len(found) > 1 else None


def _stands(run: RunData, touching: Mask) -> list[int]:
    """Return the rows from which on the payload stands with all rotors stopped."""
    stands = touching & np.all(run.thrust < _STOPPED, axis=1)
    return [int(row) for row in np.flatnonzero(stands & ~np.append(False, stands[:-1]))]


def is_set_down(landing: Mapping[str, Any]) -> bool:
    """Return whether the payload was set down safely, by the figures of :func:`landing_figures`."""
    speed = landing["speed_mps"]
    return bool(
        landing["on_ground"]
        and landing["tilt_deg"] <= UPRIGHT_DEG
        and (speed is None or speed < TOUCHDOWN_SPEED)
        and not landing["contacts_before"]
    )


def onsets(touching_pairs: Array) -> int:
    """Return how often a pair began to touch; a lasting touch counts once."""
    return int(np.clip(np.diff(touching_pairs, prepend=0.0), 0.0, None).sum())


def in_air(run: RunData) -> slice:
    """Return the rows from lift-off to touch-down; of a payload that never lifts off, those with thrust."""
    height = _height(run, rotation_from_quaternion(run.payload_quaternion))
    airborne, touching = np.flatnonzero(height > _AIRBORNE), height <= _TOUCHING
    if not len(airborne):
        powered = np.flatnonzero(np.any(run.thrust > 0.0, axis=1))
        return slice(powered[0], powered[-1] + 1) if len(powered) else slice(0)
    before, after = np.flatnonzero(touching[: airborne[0]]), np.flatnonzero(touching[airborne[-1] :])
    begin = before[-1] if len(before) else 0
    end = airborne[-1] + after[0] + 1 if len(after) else len(run.time)
    return slice(int(begin), int(end))


def is_clear_of_ground(run: RunData, height: float) -> Mask:
    """Return when the payload is more than ``height`` (m) above ground and pad (T,)."""
    return np.asarray(_height(run, rotation_from_quaternion(run.payload_quaternion)) > height)


def _height(run: RunData, rotation: Array) -> Array:
    """Return the least distance of the payload to the ground and to the pad (T,) (m)."""
    hull, about_home = run.payload, run.pad
    height = np.min(-run.payload_position[:, None, 2] - rotation[:, 2] @ hull.vertices.T, axis=1)
    near = np.flatnonzero(height < _AIRBORNE + about_home.thickness)
    half = np.append(np.ptp(hull.bounds, axis=0)[:2] / 2.0 + about_home.margin, about_home.thickness / 2.0)
    place = np.append(hull.bounds.mean(axis=0)[:2], -0.5 * about_home.thickness)
    none = np.empty((len(near), 0, 3))
    nearest = height[near]
    lower_clearance(
        hull.vertices.copy(), np.ascontiguousarray(rotation[near]), none, none, 0.0, np.zeros((1, 3)),
        np.append(half, (0.0, 0.0)), np.eye(3), place - run.payload_position[near], np.full(len(near), np.nan), nearest,
    )  # fmt: skip
    height[near] = nearest
    return np.asarray(height)
