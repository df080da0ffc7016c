"""What a flight is judged by: figures with unit and limit, as the terminal prints and ``summary.json`` keeps them."""

from collections.abc import Mapping
from typing import Any, NamedTuple


class Judged(NamedTuple):
    """A figure that a flight is judged by."""

    what: str
    unit: str
    """Empty: it is a number of times."""
    at_least: bool = False
    """Whether its limit is the least that is allowed, else the largest."""


FIGURES = {
    "clearance": Judged("least clearance", "m", at_least=True),
    "position_rmse": Judged("position error, RMS", "m"),
    "payload_tilt_deg": Judged("largest payload angle", "deg"),
    "arrival": Judged("waypoints missed by", "m"),
    "uav_separation": Judged("least distance of two UAVs", "m", at_least=True),
    "touchdown_speed": Judged("touchdown speed", "m/s"),
    "contacts": Judged("contacts", ""),
}
"""By name, in the order in which they are shown; all but ``contacts`` are keys of a mission's ``[limits]``."""
LIMITS = tuple(name for name in FIGURES if name != "contacts")


def result_rows(
    values: Mapping[str, float | None], limits: Mapping[str, float], *, has_barriers: bool
) -> list[dict[str, Any]]:
    """Return a row for each of :data:`FIGURES`, with its limit and whether it is held (None: it has none).

    A limit is held when its figure is known and within it; a clearance also when there is nothing to keep clear of
    (``has_barriers`` False).
    """
    rows = []
    for name, (what, unit, at_least) in FIGURES.items():
        value, limit = values[name], limits.get(name)
        held = None
        if limit is not None and value is None:
            held = name == "clearance" and not has_barriers
        elif limit is not None and value is not None:
            held = value >= limit if at_least else value <= limit
        rows.append(
            {
                "name": name,
                "what": what,
                "value": value,
                "unit": unit,
                "bound": "at least" if at_least else "at most",
                "limit": limit,
                "held": held,
            }
        )
    return rows
